// SPDX-License-Identifier: GPL-3.0-or-later
// The command `verify`: a certificate for a geometry image, as text and JSON.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "harness/clock.h"
#include "harness/commands.h"
#include "harness/variants.h"
#include "reports/files.h"
#include "scenes/error.h"
#include "tracer/scene_tree.h"
#include "tracer/verify.h"

namespace plumbline {
namespace {

constexpr int kVerifySchemaVersion = 1;
constexpr std::size_t kShownOfRule = 4;  ///< findings on the terminal; JSON has all that the certificate keeps

struct VerifyArguments {
  std::string subject, scene, json;
  BakeOptions options;
};

/// What is judged, and what it is judged by.
struct Subject {
  GeometryImage image;
  std::unique_ptr<Scene> scene;
  std::unique_ptr<SceneTree> tree;
  double bake_seconds = 0.0;  ///< of tree and image; 0: not baked here
};

Subject subject_of(const VerifyArguments& a) {
  Subject s;
  const bool is_image = std::filesystem::path(a.subject).extension() == ".exr";
  if (is_image) s.image = read_geometry_image(a.subject);
  if (is_image && a.scene.empty()) return s;
  if (!is_image && !a.scene.empty())
    throw InputError("--scene is for a TREE.exr; " + a.subject + " is a scene already and is baked here");
  s.scene = std::make_unique<Scene>(load_to_trace(is_image ? a.scene : a.subject));
  const BakeOptions options = is_image ? s.image.options : a.options;
  const auto start = Clock::now();
  s.tree = std::make_unique<SceneTree>(
      build_scene_tree(*s.scene, options.tree, options.transform_list == TransformList::root));
  if (is_image) return s;
  s.image = bake(*s.scene, *s.tree, options);
  s.bake_seconds = seconds_since(start);
  return s;
}

std::string place_of(const Finding& f) {
  std::string text;
  if (f.x >= 0) text += "texel (" + std::to_string(f.x) + ", " + std::to_string(f.y) + ")";
  if (f.node != kNone) text += (text.empty() ? "" : ", ") + std::string("number ") + std::to_string(f.node);
  return text.empty() ? "the image" : text;
}

/// Whether a rule was decided: what it needs was given, and nothing that is broken kept it from being looked at.
bool is_judged(const VerifyRule& rule, const Subject& s, const Certificate& c) {
  return (rule.needs == VerifyRule::Needs::image || s.scene != nullptr) &&
         !c.undecided.contains(std::string(rule.name));
}

void print_certificate(const std::string& name, const Subject& s, const Certificate& c) {
  const GeometryImage& image = s.image;
  std::printf("image        %s: %d x %d texels, %s\n", name.c_str(), image.width, image.height,
              variant_name(image.options).c_str());
  std::printf("             %zu nodes in %zu regions, %zu leaves, %zu deep at most; %zu primitives, %zu transforms\n",
              c.nodes, c.regions, c.leaves, c.depth, c.primitives, c.transforms);
  std::printf("walks        end after %llu nodes at most\n", static_cast<unsigned long long>(c.longest_walk));
  if (c.slack.count > 0)
    std::printf("slack        radius over the smallest ball's: %.4f to %.4f, median %.4f, of %zu nodes\n", c.slack.min,
                c.slack.max, c.slack.median, c.slack.count);
  if (c.split_triangles > 0) std::printf("split        %zu triangles stand in several leaves\n", c.split_triangles);
  if (c.denormals > 0)
    std::printf("denormal     %llu coordinates, as the scene has them\n", static_cast<unsigned long long>(c.denormals));
  for (const VerifyRule& rule : verify_rules()) {
    const auto count = c.counts.find(std::string(rule.name));
    if (count == c.counts.end()) continue;
    std::printf("\n%s: broken %llu times\n  must hold: %s\n  to a ray:  %s\n", std::string(rule.name).c_str(),
                static_cast<unsigned long long>(count->second), std::string(rule.says).c_str(),
                std::string(rule.effect).c_str());
    std::size_t shown = 0;
    for (const Finding& f : c.findings)
      if (f.rule == rule.name && shown++ < kShownOfRule)
        std::printf("  %s: %s\n", place_of(f).c_str(), f.message.c_str());
    if (count->second > kShownOfRule)
      std::printf("  and %llu more\n", static_cast<unsigned long long>(count->second - kShownOfRule));
  }
  std::size_t judged = 0;
  for (const VerifyRule& rule : verify_rules()) judged += is_judged(rule, s, c);
  std::string undecided;
  for (const std::string& rule : c.undecided) undecided += (undecided.empty() ? "" : ", ") + rule;
  std::printf("%sverdict      %s; %zu of %zu rules judged%s\n", c.is_sound() ? "" : "\n",
              c.is_sound() ? "sound" : "BROKEN", judged, verify_rules().size(),
              s.scene == nullptr ? ", some need the scene: give --scene SCENE" : "");
  if (!undecided.empty())
    std::printf("             not decided, because something else is broken: %s\n", undecided.c_str());
  std::printf("time         %.2f s", c.seconds);
  if (s.bake_seconds > 0.0) std::printf("; the bake took %.2f s", s.bake_seconds);
  std::printf("\n");
}

std::string certificate_json(const std::string& name, const Subject& s, const Certificate& c) {
  using Json = nlohmann::ordered_json;
  Json rules = Json::array(), findings = Json::array();
  for (const VerifyRule& rule : verify_rules()) {
    const auto count = c.counts.find(std::string(rule.name));
    rules.push_back({{"name", rule.name},
                     {"says", rule.says},
                     {"effect", rule.effect},
                     {"judged", is_judged(rule, s, c)},
                     {"broken", count == c.counts.end() ? 0 : count->second}});
  }
  for (const Finding& f : c.findings) {
    Json entry = {{"rule", f.rule}, {"message", f.message}, {"effect", f.effect}};
    if (f.x >= 0) entry["x"] = f.x, entry["y"] = f.y;
    if (f.node != kNone) entry["node"] = f.node;
    findings.push_back(std::move(entry));
  }
  Json out = {{"format", "plumbline certificate"},
              {"schema_version", kVerifySchemaVersion},
              {"image", name},
              {"variant", variant_name(s.image.options)},
              {"width", s.image.width},
              {"height", s.image.height},
              {"sound", c.is_sound()},
              {"regions", c.regions},
              {"nodes", c.nodes},
              {"leaves", c.leaves},
              {"depth", c.depth},
              {"primitives", c.primitives},
              {"transforms", c.transforms},
              {"split_triangles", c.split_triangles},
              {"longest_walk", c.longest_walk},
              {"seconds", c.seconds},
              {"rules", rules},
              {"findings", findings}};
  if (c.slack.count > 0)
    out["slack"] = {{"min", c.slack.min}, {"median", c.slack.median}, {"max", c.slack.max}, {"nodes", c.slack.count}};
  return out.dump(2) + "\n";
}

int verify(const VerifyArguments& a) {
  const Subject s = subject_of(a);
  const Certificate c = certify(s.image, s.scene.get(), s.tree.get());
  print_certificate(a.subject, s, c);
  if (!a.json.empty()) write_text(a.json, certificate_json(a.subject, s, c));
  return c.is_sound() ? 0 : 1;
}

}  // namespace

void add_verify_command(CLI::App& app, Commands& commands) {
  const auto a = std::make_shared<VerifyArguments>();
  CLI::App* sub =
      app.add_subcommand("verify", "Prove without a ray that a geometry image is sound, or name what is broken");
  sub->add_option("SUBJECT", a->subject, "TREE.exr, or a scene, which is baked first")->required();
  sub->add_option("--scene", a->scene, "The scene of a TREE.exr: what is stored is then held against it");
  sub->add_option("--json", a->json, "Write the certificate to this file too, with every finding");
  add_bake_options(*sub, a->options);
  commands.emplace_back(sub, [a] { return verify(*a); });
}

}  // namespace plumbline
