// SPDX-License-Identifier: MIT
// The certificate: sound images of every kind pass.
#include "tracer/verify.h"

#include <catch2/catch.hpp>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "tracer/image_view.h"
#include "tracer/inspect.h"
#include "tracer/inspect_figures.h"
#include "tracer/tree_test_scenes.h"

namespace plumbline {
namespace {

std::vector<BakeOptions> all_variants(bool with_lists) {
  std::vector<BakeOptions> all;
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb})
      for (const Links links : {Links::octant, Links::threaded})
        for (const TransformList list : {TransformList::tree, TransformList::root}) {
          if (list == TransformList::root && !with_lists) continue;
          BakeOptions options;
          options.layout = layout, options.bounds = bounds, options.links = links, options.transform_list = list;
          options.width = 16;
          all.push_back(options);
        }
  return all;
}

std::string described(const BakeOptions& o) {
  return std::string(name_of(o.layout)) + " " + name_of(o.bounds) + " " + name_of(o.links) + " " +
         name_of(o.transform_list);
}

std::string listed(const Certificate& certificate) {
  std::string text;
  for (const auto& [rule, count] : certificate.counts) text += rule + ": " + std::to_string(count) + "\n";
  for (std::size_t i = 0; i < certificate.findings.size() && i < 4; ++i)
    text += certificate.findings[i].rule + ": " + certificate.findings[i].message + "\n";
  return text;
}

/// Every variant of the scene passes, with and without the scene at hand.
void check_sound(const Scene& scene, const TreeOptions& tree_options = {}, bool all = true) {
  std::vector<SceneTree> trees{build_scene_tree(scene, tree_options)};
  if (!scene.nodes.empty()) trees.push_back(build_scene_tree(scene, tree_options, true));
  for (const BakeOptions& options : all_variants(!scene.nodes.empty())) {
    // Two that share nothing stand for all where there are many scenes.
    const bool is_first = options.layout == Layout::compact && options.bounds == Bounds::sphere &&
                          options.links == Links::octant && options.transform_list == TransformList::tree;
    const bool is_last = options.layout == Layout::paper && options.bounds == Bounds::aabb &&
                         options.links == Links::threaded && options.transform_list == TransformList::tree;
    if (!all && !is_first && !is_last) continue;
    const SceneTree& tree = trees[options.transform_list == TransformList::root];
    const GeometryImage image = bake(scene, tree, options);
    const Certificate alone = certify(image), full = certify(image, &scene, &tree);
    INFO(scene.name << " " << described(options));
    INFO(listed(alone) << listed(full));
    CHECK(alone.is_sound());
    CHECK(full.is_sound());
    CHECK(full.longest_walk == image.cell_count);
  }
}

}  // namespace

TEST_CASE("sound images of every variant pass: generated scenes", "[verify]") {
  check_sound(Scene{});
  for (const char* name : {"creature", "tetra", "sphereflake:2", "cube"}) check_sound(load_scene(name));
  check_sound(random_scene(1, 200, 200));
}

TEST_CASE("sound images of every variant pass: split triangles", "[verify]") {
  for (const float split : {0.05f, 0.3f}) {
    TreeOptions options;
    options.split_long = split;
    check_sound(random_scene(3, 100, 30, 1.0f), options);
    options.leaf_size = 1;
    check_sound(random_scene(3, 100, 0, 1.0f), options);
  }
}

TEST_CASE("sound images of every variant pass: scenes that break builders", "[verify]") {
  TreeOptions options;
  options.split_long = 0.0625f;  // the search for the best takes three times as long
  for (const Scene& scene : nasty_scenes()) {
    if (scene.name == "a heap at one point, another far away") {
      // Brought to a radius that 32 bits can walk, its spheres are too small for a float: the certificate says so.
      const Certificate lost = certify(bake(scene));
      CHECK(lost.counts.size() == 1);
      CHECK(lost.counts.count("texel_denormal") == 1);
      continue;
    }
    try {
      check_sound(scene, options, false);
    } catch (const InputError&) {
      // The builder refuses some of them.
    }
  }
}

TEST_CASE("numbers of spheres are judged once each", "[verify]") {
  Scene scene;
  scene.name = "two_spheres";
  scene.materials.resize(1);
  scene.spheres = {{{0, 0, 0}, 1.0f, 0}, {{1e-40f, 0, 1}, 3.0f, 0}};
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    BakeOptions options;
    options.layout = layout, options.width = 16;
    CHECK(certify(bake(scene, options)).denormals == 1);
    Scene tiny = scene;
    tiny.spheres = {{{0, 0, 0}, 1.0f, 0}, {{0, 0, 1}, 1e-40f, 0}};
    const GeometryImage small = bake(tiny, options);
    const SceneTree tree = build_scene_tree(tiny, options.tree);
    INFO(listed(certify(small, &tiny, &tree)));
    CHECK(certify(small).counts == std::map<std::string, std::uint64_t>{{"texel_denormal", 1}});  // nobody to ask
    CHECK(certify(small, &tiny, &tree).is_sound());
    // A scene that has no such radius does not allow it.
    tiny.spheres[1].radius = 0.5f;
    CHECK(certify(small, &tiny).counts.at("texel_denormal") == 1);

    GeometryImage broken = bake(scene, options);
    const auto radius_at = [&](std::uint32_t k) -> glm::vec4& { return broken.texels[primitive_texels(broken, k)[1]]; };
    radius_at(0).x = -1.0f;
    CHECK(certify(broken).counts.at("label") == 1);
    CHECK(certify(broken).counts.count("texel_denormal") == 0);
    radius_at(0).x = 0.0f;
    CHECK(certify(broken).counts.at("texel_denormal") == 1);
    broken = bake(scene, options);
    radius_at(0).y = 1.0f;
    CHECK(certify(broken).counts.at("texel_unused") == 1);
  }
  // Beside triangles, a sphere has a texel to spare.
  const GeometryImage sound = bake(random_scene(1, 4, 4));
  REQUIRE(certify(sound).is_sound());
  for (std::uint32_t k = 0; k < sound.primitive_count; ++k) {
    if (stored_primitive(sound, k).is_triangle) continue;
    GeometryImage broken = sound;
    broken.texels[primitive_texels(broken, k)[2]].x = 1.0f;
    CHECK(certify(broken).counts.at("texel_unused") == 1);
  }
}

TEST_CASE("a texel that is no number names its node", "[verify]") {
  const GeometryImage sound = bake(load_scene("nested"));
  const InspectedImage inspected = inspect_image(sound);
  REQUIRE(inspected.regions.size() > 2);
  for (const InspectedNode& node : inspected.nodes) {
    GeometryImage image = sound;
    image.texels[unit_texel(image, node.unit)].y = std::nanf("");
    const Certificate broken = certify(image);
    const auto found = std::find_if(broken.findings.begin(), broken.findings.end(),
                                    [](const Finding& f) { return f.rule == "texel_nan"; });
    REQUIRE(found != broken.findings.end());
    CHECK(found->node == node.number);
  }
}

TEST_CASE("what is not decided is told", "[verify]") {
  const Scene scene = load_scene("nested");
  const GeometryImage sound = bake(scene);
  CHECK(certify(sound, &scene).undecided.empty());
  // Two leaves that lead to one transform: nothing behind transforms is looked at.
  const InspectedImage inspected = inspect_image(sound);
  std::vector<InspectedNode> leaves;
  for (const InspectedNode& node : inspected.nodes) {
    if (node.transform == kNone) continue;
    if (leaves.size() == 1 && leaves[0].region != node.region) leaves.clear();
    if (leaves.size() < 2) leaves.push_back(node);
  }
  REQUIRE(leaves.size() >= 2);
  GeometryImage image = sound;
  image.texels[leaves[1].unit].w = image.texels[leaves[0].unit].w;
  CHECK(certify(image).undecided == std::set<std::string>{"ball", "containment", "padding"});
  // Sizes that do not fit: nothing else is.
  image = sound;
  ++image.transform_start;
  // All that could be judged with what is given, but for the rule that is broken.
  const auto rules_up_to = [](VerifyRule::Needs most) {
    const auto rules = verify_rules();
    return static_cast<std::size_t>(
        std::count_if(rules.begin(), rules.end(), [&](const VerifyRule& r) { return r.needs <= most; }));
  };
  CHECK(certify(image).undecided.size() == rules_up_to(VerifyRule::Needs::image) - 1);
  CHECK(certify(image, &scene).undecided.size() == rules_up_to(VerifyRule::Needs::scene) - 1);
  // Another scene's primitives are not compared.
  const Scene other = load_scene("cube");
  CHECK(certify(sound, &other).undecided.count("primitive_bits") == 1);
}

TEST_CASE("a triangle that takes too long to look at is not said to stick out", "[verify]") {
  // Two boxes cover it, but share so little that only tiny pieces lie in one of them.
  TreeOptions tree;
  tree.split_long = 0.3f, tree.leaf_size = 1;
  BakeOptions options;
  options.bounds = Bounds::aabb, options.links = Links::threaded, options.width = 16, options.tree = tree;
  GeometryImage image = bake(random_scene(3, 100, 0, 1.0f), options);
  REQUIRE(certify(image).split_triangles > 0);
  std::set<float> seen;
  const float reach = 4.0f * (image.radius + glm::length(image.center));
  for (const InspectedNode& node : inspect_image(image).nodes) {
    glm::vec4 &lower = image.texels[node.unit], &upper = image.texels[node.unit + 1];
    lower = glm::vec4(glm::vec3(-reach), lower.w), upper = glm::vec4(glm::vec3(reach), upper.w);
    if (!node.is_leaf) continue;
    const StoredPrimitive p = stored_primitive(image, node.cluster);
    const float left = std::min({p.a.x, p.b.x, p.c.x}), size = std::max({p.a.x, p.b.x, p.c.x}) - left;
    if (size < 0.5f * image.radius) continue;
    const bool is_first = seen.insert(std::fabs(p.label)).second;
    (is_first ? upper.x : lower.x) = left + size * (is_first ? 0.33335f : 0.33325f);
  }
  const Certificate certificate = certify(image);
  INFO(listed(certificate));
  std::size_t undecided = 0;
  for (const Finding& finding : certificate.findings)
    undecided += finding.message.find("is not decided") != std::string::npos;
  CHECK(undecided > 0);
  CHECK(certificate.undecided == std::set<std::string>{"containment", "padding"});
}

TEST_CASE("the certificate's slack is that of the figures", "[verify]") {
  for (const char* name : {"creature", "tetra", "sphereflake:2"}) {
    const GeometryImage image = bake(load_scene(name));
    const Summary slack = figures_of(image, inspect_image(image)).slack;
    const Certificate certificate = certify(image);
    CHECK(certificate.slack.count == slack.count);
    CHECK(certificate.slack.median == slack.median);
  }
}

TEST_CASE("labels without signs cost no more than sound ones", "[verify]") {
  const GeometryImage sound = bake(load_scene("grid:20000"));
  GeometryImage image = sound;
  for (std::uint32_t k = 0; k < image.primitive_count; ++k) {
    float& label = image.texels[primitive_texels(image, k)[0]].w;
    label = std::fabs(label);
  }
  const Certificate broken = certify(image, nullptr, nullptr, 1);
  CHECK(broken.counts.count("label") == 1);
  CHECK(broken.counts.count("containment") == 0);  // a leaf is not blamed for what stands below the next
  CHECK(broken.seconds < 5.0);                     // 28 s where each leaf walks to the end of the image
  std::size_t primitives = 0;
  for (const InspectedNode& node : inspect_image(image).nodes)
    if (node.is_leaf) primitives += node.primitives;
  CHECK(primitives == image.primitive_count);
}

TEST_CASE("sound images of every variant pass: scenes with transforms", "[verify]") {
  TreeOptions options;
  options.split_long = 0.0f;
  for (const std::string& name : shipped_scenes()) check_sound(load_scene(name), options);
}

}  // namespace plumbline
