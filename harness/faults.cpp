// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/faults.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "harness/bundle_cases.h"
#include "harness/explain.h"
#include "harness/hit_cases.h"
#include "scenes/error.h"
#include "scenes/generate.h"

namespace plumbline {
namespace {

constexpr std::size_t kRays = std::size_t{1} << 16;  ///< per family

/// A sphereflake without its floor, so that the spheres are not small against the scene.
Scene flake() {
  Scene scene = generate_scene("sphereflake", 2);
  scene.triangles.clear();
  scene.positions.clear();
  return scene;
}
Scene creature() { return generate_scene("creature"); }

// Nodes of a compact image with bounding spheres: one texel each, the word in w.
std::uint32_t word_of(const GeometryImage& image, std::uint32_t i) {
  return std::bit_cast<std::uint32_t>(image.texels[i].w);
}
bool is_leaf(std::uint32_t word) { return (word >> 31) != 0; }

/// In every copy of the tree, the node of the largest sphere that is a leaf is made smaller by `share` of the radius
/// that its primitives need.
void shrink_largest_leaf(GeometryImage& image, const Stage& stage, double share) {
  const TreeNode* largest = nullptr;
  for (const TreeNode& node : stage.tree.world.nodes)
    if (node.is_leaf() && (!largest || node.radius > largest->radius)) largest = &node;
  PLUMBLINE_ASSERT(largest);
  const double radius = (1.0 - share) * static_cast<double>(largest->radius);
  const std::uint32_t payload_mask = (1u << image.payload_bits) - 1u;
  for (std::uint32_t i = 0; i < image.copy_count * image.copy_size; ++i) {
    glm::vec4& texel = image.texels[i];
    const std::uint32_t word = word_of(image, i);
    if (!is_leaf(word) || word == kEndWord || glm::vec3(texel) != largest->center) continue;
    // The payload stays; what remains of the radius is rounded down.
    const std::uint32_t smaller =
        (std::bit_cast<std::uint32_t>(static_cast<float>(radius * radius)) & ~payload_mask) | (word & payload_mask);
    const std::uint32_t floored =
        std::bit_cast<float>(smaller) > static_cast<float>(radius * radius) ? smaller - (payload_mask + 1u) : smaller;
    texel.w = std::bit_cast<float>(floored | 0x80000000u);
  }
}

/// In every copy, two inner nodes exchange where they lead when they are not hit.
void swap_two_skips(GeometryImage& image) {
  const std::uint32_t payload_mask = (1u << image.payload_bits) - 1u;
  for (std::uint32_t copy = 0; copy < image.copy_count; ++copy) {
    std::vector<std::uint32_t> inner;
    for (std::uint32_t i = copy * image.copy_size; i < (copy + 1) * image.copy_size; ++i)
      if (!is_leaf(word_of(image, i))) inner.push_back(i);
    // Skips only lead on, so a walk over swapped ones still ends; the one that leads too far loses what it jumps over.
    const auto short_skip = std::min_element(inner.begin() + 1, inner.end(), [&](auto a, auto b) {
      return (word_of(image, a) & payload_mask) < (word_of(image, b) & payload_mask);
    });
    const auto long_skip = std::max_element(inner.begin() + 1, inner.end(), [&](auto a, auto b) {
      return (word_of(image, a) & payload_mask) < (word_of(image, b) & payload_mask);
    });
    const std::uint32_t a = word_of(image, *short_skip), b = word_of(image, *long_skip);
    image.texels[*short_skip].w = std::bit_cast<float>((a & ~payload_mask) | (b & payload_mask));
    image.texels[*long_skip].w = std::bit_cast<float>((b & ~payload_mask) | (a & payload_mask));
  }
}

Scene nested() { return load_scene("nested"); }
Scene shear() { return load_scene("shear"); }
Scene around_eye() { return load_scene("around_eye"); }

/// The nested scene with every node that stands in the world a step away from its place at rest.
Scene nested_moved() {
  Scene scene = nested();
  const auto step = static_cast<float>(1.5 * bounding_ball(scene).radius);
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n)
    if (scene.nodes[n].parent == kNone)
      scene.nodes[n].transform.translation += glm::vec3(n % 2 == 0 ? step : -step, step, 0.0);
  return scene;
}

/// Spheres as they stand when every node is at rest, over records of where the nodes are now.
void forget_to_refit(GeometryImage& image, const Stage& stage) {
  Scene at_rest = stage.scene;
  for (Node& node : at_rest.nodes) node.transform = node.rest;
  const GeometryImage before = bake(at_rest, image.options);
  PLUMBLINE_ASSERT(before.primitive_start == image.primitive_start && before.texels.size() == image.texels.size());
  std::copy_n(before.texels.begin(), image.primitive_start, image.texels.begin());
}

/// What can go wrong with transforms (the paper, section 6).
void add_transform_faults(std::vector<Fault>& faults) {
  using V = Verdict;
  const std::vector<V> expected{V::tracer_wrong, V::leak, V::capped};
  const auto add = [&](const char* name, const char* what, Scene (*scene)(), const char* file, const char* find,
                       const char* replace, TransformOut out = TransformOut::restore) {
    faults.push_back({name, what, scene, expected, {}, {{file, find, replace}}, out});
  };
  add("transform_out_missing", "The ray is not taken out of a transform again.", nested, "change_space.glsl",
      "derive_ray(outer);", "");
  add("out_by_the_matrix_of_in", "The way out of a transform multiplies by the matrix of the way in.", nested,
      "change_space.glsl",
      "vec4 row_0 = record_texel(node, 3), row_1 = record_texel(node, 4), row_2 = record_texel(node, 5);",
      "vec4 row_0 = record_texel(node, 0), row_1 = record_texel(node, 1), row_2 = record_texel(node, 2);",
      TransformOut::inverse);
  add("normal_by_the_matrix", "Normals come out by the matrix instead of the inverse transpose.", shear,
      "result.glsl", "normal = times_transposed(back_0, back_1, back_2, normal);",
      "normal = times(row_0, row_1, row_2, normal);");
  add("t_left_local", "t stays in units of the instance's walking ray.", nested, "candidate.glsl",
      "PRECISE float t_world = t * ray.t_scale + ray.t_shift;", "PRECISE float t_world = t;");
  add("parents_matrix_only", "A node inside another is entered with the outer one's matrix alone.", nested,
      "change_space.glsl", "  enter_space(node);\n  derived_octant",
      "  if (record_texel(node, 7).z < 1.5) enter_space(node);\n  derived_octant");
  faults.push_back({"sphere_not_refitted",
                    "Nodes have moved, but the spheres above them stand where they were.",
                    nested_moved,
                    expected,
                    forget_to_refit,
                    {}});
  add("transform_behind_the_eye", "A transform whose own origin lies behind the ray's is not entered.", around_eye,
      "walk_compact.glsl", "    if (in_cluster && transform >= 0) walk.request = transform;",
      "    vec3 pivot = vec3(record_texel(max(transform, 0), 0).w, record_texel(max(transform, 0), 1).w,\n"
      "                      record_texel(max(transform, 0), 2).w);\n"
      "    bool is_behind = dot(pivot - ray.o, ray.dn) < 0.0;\n"
      "    if (in_cluster && transform >= 0 && !is_behind) walk.request = transform;\n"
      "    if (in_cluster && transform >= 0 && is_behind) at += NODE_TEXELS;");
  add("instance_of_the_parent", "The instance reported is the node around it.", nested, "result.glsl",
      "hit ? uint(nearest.space + 1) : 0u", "hit && nearest.space >= 0 ? uint(record_texel(nearest.space, 3).w) : 0u");
}

}  // namespace

std::vector<Fault> all_faults() {
  using V = Verdict;
  std::vector<Fault> faults;
  const auto shader = [&](const char* name, const char* what, Scene (*scene)(), std::vector<V> expected,
                          const char* file, const char* find, const char* replace) {
    faults.push_back({name, what, scene, std::move(expected), {}, {{file, find, replace}}});
  };
  faults.push_back({"sphere_shrunk",
                    "One bounding sphere is smaller by 1e-4 of the radius that it needs.",
                    flake,
                    {V::tracer_wrong},
                    [](GeometryImage& image, const Stage& stage) { shrink_largest_leaf(image, stage, 1e-4); },
                    {}});
  faults.push_back({"links_swapped",
                    "Two nodes exchange their out links.",
                    creature,
                    {V::tracer_wrong, V::leak, V::capped},
                    [](GeometryImage& image, const Stage&) { swap_two_skips(image); },
                    {}});
  shader("radius_not_squared", "The node test compares the distance, not its square, with the squared radius.",
         creature, {V::tracer_wrong, V::leak}, "bounds.glsl", "return dot(f, f);", "return length(f);");
  shader("t_max_without_its_square", "The node test ends at the root of the nearest t, not at t itself.", creature,
         {V::tracer_wrong, V::leak}, "bounds.glsl", "clamp(dot(m, ray.dn), 0.0, nearest.t)",
         "clamp(dot(m, ray.dn), 0.0, sqrt(nearest.t))");
  shader("edge_excluded", "Edges and corners no longer belong to a triangle: < for <=.", creature, {V::leak},
         "triangle.glsl", "hit.inside = min(min(u, v), w) >= 0.0 || max(max(u, v), w) <= 0.0;",
         "hit.inside = min(min(u, v), w) > 0.0 || max(max(u, v), w) < 0.0;");
  shader("first_hit", "The first hit is kept instead of the nearest.", creature, {V::tracer_wrong, V::leak},
         "candidate.glsl", "(t < nearest.t || (t == nearest.t && label < nearest.label))",
         "t <= nearest.t && nearest.label >= NO_LABEL");
  shader("behind_the_origin", "Hits behind the ray's origin count.", creature, {V::tracer_wrong}, "candidate.glsl",
         "if (hit && t > ray.t_low && (t < nearest.t ||", "if (hit && (t < nearest.t ||");
  shader("t_max_exclusive_by_far", "Hits in the last thousandth before t_max are lost.", creature,
         {V::tracer_wrong, V::leak}, "ray_prepare.glsl", "float t_end = scale_exactly(t_max, -ray.exponent);",
         "float t_end = scale_exactly(t_max, -ray.exponent) * 0.999;");
  shader("far_root_first", "A sphere answers with the far root although the near one is valid.", flake,
         {V::tracer_wrong}, "sphere.glsl", "enter > ray.t_low ? enter", "enter <= ray.t_low ? enter");
  shader("normal_turned", "The normal of a triangle points the other way.", creature, {V::tracer_wrong},
         "triangle.glsl", "return n * (1.0 / sqrt(dot(n, n)));", "return n * (-1.0 / sqrt(dot(n, n)));");
  shader("weights_exchanged", "The weights of the second and third corner are exchanged.", creature, {V::tracer_wrong},
         "triangle.glsl", "hit.weights = vec2(v, w) * inverse;", "hit.weights = vec2(w, v) * inverse;");
  shader("cluster_cut_short", "The last primitive of a cluster is not tested.", creature, {V::tracer_wrong, V::leak},
         "candidate.glsl", "  offer(hit, t, label, address, weights);\n#ifdef HAS_TRIANGLES\n  if (pending)",
         "  offer(hit && p0.w > 0.0, t, label, address, weights);\n#ifdef HAS_TRIANGLES\n  if (pending)");
  shader("t_off_by_1e-5", "t is too large by one part in 10^5.", creature, {V::tracer_wrong}, "triangle.glsl",
         "hit.t = (((u * a.z + v * b.z) + w * c.z) * inverse) * ray.shear.z;",
         "hit.t = (((u * a.z + v * b.z) + w * c.z) * inverse) * ray.shear.z * 1.00001;");
  add_transform_faults(faults);
  faults.push_back({"nearest_of_another_ray",
                    "The rays of a bundle are cut off at the nearest hit of its first.",
                    creature,
                    {V::tracer_wrong},
                    {},
                    {{"bundle.glsl", "nearest = bundle_nearest[K]", "nearest = bundle_nearest[0]"}},
                    TransformOut::restore,
                    2});
  return faults;
}

namespace {

/// Of rays that walk together: the case is `bundles`, and the layer is none of those that one ray's walk knows.
FaultResult run_bundle_fault(Session& session, const Stage& stage, const Fault& fault, std::uint64_t seed) {
  FaultResult result{fault.name, fault.what, {}, Verdict::agree, Layer::none, {}};
  const std::vector<Ray> rays = bundled_rays(stage.rays, seed, 1 << 8);
  std::vector<Hit> alone(rays.size()), sound(rays.size()), faulty(rays.size());
  session.probe(stage, fault.out).trace(rays, alone);
  session.bundles(stage, fault.bundle, fault.out).trace(rays, sound);
  Probe broken(session.context(), stage.image_of(fault.out), BundleSize{fault.bundle}, fault.patches);
  broken.trace(rays, faulty);
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!same_bits(sound[i], alone[i]))
      throw EnvironmentError("a bundle answers otherwise than its rays without the fault " + fault.name);
    wrong += !same_bits(faulty[i], alone[i]);
  }
  if (wrong == 0) return result;
  result.verdict = Verdict::tracer_wrong;
  result.caught_by = "bundles." + std::to_string(fault.bundle) + "." + stage.scene.name + ": " + std::to_string(wrong) +
                     " of " + std::to_string(rays.size()) + " rays tracer_wrong";
  result.sentence = "alone the ray is answered rightly; it is lost in its bundle";
  return result;
}

}  // namespace

FaultResult run_fault(Session& session, const Fault& fault, std::uint64_t seed) {
  Stage& stage = session.stage("fault " + fault.name, fault.scene());
  if (fault.bundle > 1) return run_bundle_fault(session, stage, fault, seed);
  const Judge judge = stage.judge_of(fault.out);
  GeometryImage image = stage.image_of(fault.out);
  if (fault.change_image) fault.change_image(image, stage);
  Probe broken(session.context(), image, Traversal::tree, fault.patches);

  FaultResult result{fault.name, fault.what, {}, Verdict::agree, Layer::none, {}};
  std::vector<Ray> rays(kRays);
  for (const RayFamilyInfo& family : ray_families()) {
    generate_rays_parallel(stage.rays, family.family, seed, 0, rays);
    TraceBuffers buffers;
    Tally sound, faulty;
    trace_and_judge(judge, session.probe(stage, fault.out), stage.embree, rays, 0, seed, buffers, sound);
    for (const Verdict v : kVerdicts)
      if (is_failure(v) && sound[v] > 0)
        throw EnvironmentError("the tracer fails " + std::string(family.name) + " on the scene of fault " + fault.name +
                               " without the fault");
    trace_and_judge(judge, broken, stage.embree, rays, 0, seed, buffers, faulty);
    for (const Verdict v : fault.expected) {
      if (faulty[v] == 0) continue;
      const std::string group = stage.scene.nodes.empty() ? "hits" : std::string("transforms.") + name_of(fault.out);
      result.verdict = v;
      result.caught_by = group + "." + std::string(family.name) + "." + stage.scene.name + ": " +
                         std::to_string(faulty[v]) + " of " + std::to_string(kRays) + " rays " +
                         std::string(verdict_name(v));
      for (const JudgedRay& kept : faulty.kept) {
        if (kept.judgement.verdict != v) continue;
        Examiner examiner(session, {&stage, &image, &stage.image_of(fault.out), fault.patches, fault.name});
        const Explanation e = examiner.explain(kept.ray, 20'000);
        result.layer = e.layer;
        result.sentence = e.sentence;
        break;
      }
      return result;
    }
  }
  return result;
}

std::vector<FaultResult> run_faults(std::uint64_t seed,
                                    const std::function<void(double, const std::string&)>& progress) {
  Session session;
  const std::vector<Fault> faults = all_faults();
  std::vector<FaultResult> results;
  for (const Fault& fault : faults) {
    progress(static_cast<double>(results.size()) / static_cast<double>(faults.size()), fault.name);
    results.push_back(run_fault(session, fault, seed));
  }
  return results;
}

}  // namespace plumbline
