// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `bake.verify.*` (every variant of every scene's image gets its certificate) and `bake.broken_trees` (the
// library of broken trees: who finds which fault).
#include <algorithm>

#include "harness/catalogue.h"
#include "harness/hit_cases.h"
#include "tracer/broken_trees.h"
#include "tracer/verify.h"

namespace plumbline {
namespace {

std::string place_of(int x, int y) {
  return x < 0 ? "an attribute" : "(" + std::to_string(x) + ", " + std::to_string(y) + ")";
}

/// "link_target at (3, 0): ...", of the first finding.
std::string first_finding(const Certificate& certificate) {
  const Finding& f = certificate.findings.front();
  return f.rule + " at " + place_of(f.x, f.y) + ": " + f.message;
}

bool names(const Certificate& certificate, std::string_view rule, int x, int y) {
  return std::any_of(certificate.findings.begin(), certificate.findings.end(),
                     [&](const Finding& f) { return f.rule == rule && f.x == x && f.y == y; });
}

/// Rays that two images answer differently.
std::uint64_t differing_rays(Session& session, const BrokenTree& tree, std::uint64_t seed) {
  constexpr std::size_t kOfEachFamily = 1000;
  const std::vector<Ray> rays = mixed_rays(RaySource(tree.scene), seed, kOfEachFamily);
  std::vector<Hit> sound(rays.size()), broken(rays.size());
  session.probe(tree.sound).trace(rays, sound);
  session.probe(tree.broken).trace(rays, broken);
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) differing += !same_bits(sound[i], broken[i]);
  return differing;
}

void verify_variants(CaseContext& context, const Case& self, CaseRecord& record) {
  const Stage& stage = context.session.stage(self.spec);
  const Scene& scene = stage.scene;
  if (is_skipped(stage, record)) return;
  VariantTrees trees(scene, stage.tree);
  std::vector<Variant> variants = all_variants(!scene.nodes.empty());
  variants.insert(variants.begin(), {"default", "", BakeOptions{}});
  std::size_t broken = 0;
  std::uint64_t longest = 0;
  double certify_seconds = 0.0;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const BakeOptions& options = variants[i].options;
    const SceneTree& tree = trees.of(options);
    const GeometryImage image = bake(scene, tree, options);
    const Certificate certificate = certify(image, &scene, &tree);
    certify_seconds += certificate.seconds;
    longest = std::max(longest, certificate.longest_walk);
    if (i == 0 && certificate.slack.count > 0)
      record.figures.push_back({"sphere slack, median", "1", certificate.slack.median, 0, 0, 0});
    if (!certificate.is_sound() && ++broken == 1) record.message = variants[i].name + ": " + first_finding(certificate);
    context.progress(static_cast<double>(i + 1) / static_cast<double>(variants.size()));
  }
  record.figures.push_back({"images", "", static_cast<double>(variants.size()), 0, 0, 0});
  record.figures.push_back({"longest walk", "nodes", static_cast<double>(longest), 0, 0, 0});
  record.figures.push_back({"certifying", "s", certify_seconds, 0, 0, 0});
  if (broken == 0) return;
  record.status = CaseStatus::failed;
  record.message =
      std::to_string(broken) + " of " + std::to_string(variants.size()) + " images are broken; " + record.message;
}

void find_faults(CaseContext& context, const Case& self, CaseRecord& record) {
  using Finder = TreeFault::Finder;
  TableRecord table;
  table.title = "Faults in images, and who finds them";
  table.columns = {"fault", "what is changed", "scene, layout, links, bounds", "rule of verify", "at", "found with",
                   "rays"};
  std::size_t missed = 0, at = 0;
  const auto faults = tree_faults();
  for (const TreeFault& fault : faults) {
    const BrokenTree tree = break_tree(fault, case_seed(context.seed, self.name));
    const bool image = names(certify(tree.broken), fault.rule, tree.x, tree.y),
               scene = names(certify(tree.broken, &tree.scene), fault.rule, tree.x, tree.y);
    const Certificate full = certify(tree.broken, &tree.scene, &tree.tree);
    const bool all = names(full, fault.rule, tree.x, tree.y);
    const std::uint64_t rays = differing_rays(context.session, tree, case_seed(context.seed, self.name));
    const bool found = fault.finder == Finder::nobody ? full.is_sound() && rays == 0 : all;
    missed += !found;
    table.rows.push_back({std::string(fault.name), std::string(fault.does),
                          std::string(fault.scene) + ", " + name_of(fault.layout) + ", " + name_of(fault.links) + ", " +
                              name_of(fault.bounds),
                          fault.rule.empty() ? "none" : std::string(fault.rule), place_of(tree.x, tree.y),
                          !found                           ? "NOT AS EXPECTED"
                          : fault.finder == Finder::nobody ? "harmless: nothing differs"
                          : image                          ? "the image alone"
                          : scene                          ? "the scene"
                                                           : "the scene's tree",
                          rays > 0 ? std::to_string(rays) + " differ" : "none differs"});
    if (!found && missed <= 3) record.message += (record.message.empty() ? "" : "; ") + std::string(fault.name);
    context.progress(static_cast<double>(++at) / static_cast<double>(faults.size()));
  }
  record.figures.push_back({"faults", "", static_cast<double>(faults.size()), 0, 0, 0});
  record.tables.push_back(std::move(table));
  if (missed == 0) return;
  record.status = CaseStatus::failed;
  record.message = std::to_string(missed) + " faults are not found as they should be: " + record.message;
}

}  // namespace

Case verify_case(const ListedScene& scene) {
  Case c = scene_case(
      "bake.verify." + scene.name, "bake", scene, "3",
      "The image of every variant is sound: links, bounds, transforms and primitives, proved without a ray.");
  c.run = verify_variants;
  return c;
}

Case broken_trees_case() {
  Case c;
  c.name = "bake.broken_trees";
  c.feature = "bake";
  c.paper = "3";
  c.proves = "The certificate finds every fault of the library of broken trees, by its rule and at its cell.";
  c.run = find_faults;
  return c;
}

}  // namespace plumbline
