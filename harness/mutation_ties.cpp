// SPDX-License-Identifier: GPL-3.0-or-later
// Walks whose answers follow from whole numbers: rays that meet several triangles at exactly the same t, rays that end
// exactly at a surface, and walks that never end.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "harness/mutation_oracles.h"
#include "scenes/error.h"
#include "scenes/random.h"
#include "tracer/probe.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kSeed = name_hash("mutants of ties");
constexpr int kCells = 8;  ///< of the grid, along x and along y

/// The grid's first `columns` columns, two triangles a cell, all in the plane z = 0, in any order.
void add_grid(Scene& scene, Random& random, int columns) {
  std::vector<std::array<glm::vec3, 3>> triangles;
  for (int cell = 0; cell < columns * kCells; ++cell) {
    const glm::vec3 at(static_cast<float>(cell / kCells), static_cast<float>(cell % kCells), 0.0f);
    const glm::vec3 x(1.0f, 0.0f, 0.0f), y(0.0f, 1.0f, 0.0f);
    triangles.push_back({at, at + x, at + y});
    triangles.push_back({at + x + y, at + y, at + x});
  }
  for (std::size_t i = triangles.size(); i > 1; --i)
    std::swap(triangles[i - 1], triangles[random.below(static_cast<std::uint32_t>(i))]);
  for (const auto& [a, b, c] : triangles) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {a, b, c});
    scene.triangles.emplace_back().position = {first, first + 1, first + 2};
  }
}

/// Half of the grid in the world, and all of it twice at the same place; or all of it in the world.
Scene grids(bool has_nodes) {
  Scene scene;
  scene.materials.resize(1);
  Random random(kSeed, 0, 0);
  add_grid(scene, random, has_nodes ? kCells / 2 : kCells);
  if (has_nodes) {
    const auto first = static_cast<std::uint32_t>(scene.triangles.size());
    add_grid(scene, random, kCells);
    scene.parts.push_back({"grid", first, static_cast<std::uint32_t>(scene.triangles.size()) - first, 0, 0});
    scene.nodes.push_back({"here", kNone, 0, {}, {}});
    scene.nodes.push_back({"here again", kNone, 0, {}, {}});
  }
  frame_camera(scene);
  return scene;
}

constexpr float kAnyT = -1.0f;

struct Known {
  std::uint32_t primitive = kNone;  ///< kNone: a miss
  std::uint32_t instance = kNone;
  float t = kAnyT;
};

/// What a ray along z through (x, y), from 4 above, meets first, by SEMANTICS 5: the world before instances, and then
/// by number.
Known first_of(const Scene& scene, float x, float y) {
  const auto is_inside = [&](std::uint32_t triangle) {
    const auto corners = scene.corners(triangle);
    const auto [left, right] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
    const auto [low, high] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
    if (x < left || x > right || y < low || y > high) return false;
    const float sum = (x - left) + (y - low);  // the diagonal is where it is 1
    return corners[0].x == left ? sum <= 1.0f : sum >= 1.0f;
  };
  const auto count = static_cast<std::uint32_t>(scene.triangles.size());
  const std::uint32_t world = scene.parts.empty() ? count : scene.parts[0].first_triangle;
  for (std::uint32_t p = 0; p < count; ++p)
    if (is_inside(p)) return {p, p < world ? kNone : 0, 4.0f};
  return {};
}

/// Programs that walk the image, alone or in bundles, and go on where a triangle is seen edge-on.
std::vector<ActiveLines> lines_of(const GeometryImage& image, int bundle) {
  ProgramVariant first = program_variant(image, false, false), then = first;
  then.thorough = true;
  first.bundle = bundle;
  std::vector<ActiveLines> all{active_lines(probe_vertex_shader()), active_lines(probe_fragment_shader(first)),
                               active_lines(probe_fragment_shader(then))};
  return all;
}

MutationOracle of_known(GlContext& context, std::string name, const Scene& scene, const BakeOptions& options,
                        const std::vector<Ray>& rays, const std::vector<Known>& known, int bundle = 1) {
  auto image = std::make_shared<const GeometryImage>(bake(scene, options));
  MutationOracle oracle;
  oracle.name = std::move(name) + "." + name_of(options.layout) + "_" + name_of(options.links);
  if (bundle > 1) oracle.name += ".bundles_of_" + std::to_string(bundle);
  oracle.programs = lines_of(*image, bundle);
  oracle.ask = [&context, image, rays, known, bundle](const Mutant&) -> std::string {
    std::vector<Hit> hits(rays.size());
    (bundle > 1 ? Probe(context, *image, BundleSize{bundle}) : Probe(context, *image)).trace(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool is_hit = known[i].primitive != kNone;
      const Hit& hit = hits[i];
      const float length = glm::length(hit.normal);
      if (is_hit && hit.kind == HitKind::hit && !(std::abs(length - 1.0f) < 1e-3f))
        return "ray " + std::to_string(i) + " has a normal " + std::to_string(length) + " long";
      if (hit.kind == (is_hit ? HitKind::hit : HitKind::miss) && hit.primitive == known[i].primitive &&
          hit.instance == known[i].instance && (known[i].t == kAnyT || hit.t == known[i].t))
        continue;
      return "ray " + std::to_string(i) + " names " + std::to_string(hit.primitive) + " of instance " +
             std::to_string(hit.instance) + " at " + std::to_string(hit.t) + ", and first comes " +
             std::to_string(known[i].primitive) + " of instance " + std::to_string(known[i].instance);
    }
    return {};
  };
  return oracle;
}

/// Rays through corners, edges and the inside of the grid's triangles, from 4 above it: without an end, which ends at
/// the grid, just above it, and at its start; and one that starts on the grid. In bundles, every other one ends above
/// it.
MutationOracle ties(GlContext& context, bool has_nodes, Layout layout, Links links, int bundle = 1) {
  const Scene scene = grids(has_nodes);
  BakeOptions options;
  options.layout = layout, options.links = links, options.width = 32;
  std::vector<Ray> rays;
  std::vector<Known> known;
  for (int i = 0; i <= 4 * kCells; ++i)
    for (int j = 0; j <= 4 * kCells; ++j) {
      const glm::vec3 over(0.25f * static_cast<float>(i), 0.25f * static_cast<float>(j), 4.0f);
      Ray ray{over, {0.0f, 0.0f, -1.0f}};
      const int which = bundle > 1 ? 5 * static_cast<int>((rays.size() + 1) % 2) : (i + 7 * j) % 8;
      if (which == 3) ray.origin.z = 0.0f;
      if (which == 4) ray.t_max = 4.0f;
      if (which == 5) ray.t_max = std::nextafter(4.0f, 0.0f);
      if (which == 6) ray.t_max = 0.0f;
      rays.push_back(ray);
      known.push_back(which == 3 || which == 5 || which == 6 ? Known{} : first_of(scene, over.x, over.y));
    }
  return of_known(context, has_nodes ? "ties.instances" : "ties", scene, options, rays, known, bundle);
}

/// Triangles that rays along x see all but edge-on, so that they wait for each, one behind the other: number i crosses
/// y = 0 at x = 4 i, where z is between i and i + 3. Of one alone, its address is the first and the last.
MutationOracle waiting(GlContext& context, int count, bool has_nodes, Layout layout, int bundle) {
  Scene scene;
  scene.materials.resize(1);
  for (int i = 0; i < count; ++i) {
    const float x = 4.0f * static_cast<float>(i), z = static_cast<float>(i), y = 0x1p-10f;
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {{x - 1.0f, -y, z}, {x + 1.0f, y, z}, {x, 0.0f, z + 3.0f}});
    scene.triangles.emplace_back().position = {first, first + 1, first + 2};
  }
  const float aside = has_nodes ? 16.0f : 0.0f;
  if (has_nodes) {
    scene.parts.push_back({"waiting", 0, static_cast<std::uint32_t>(count), 0, 0});
    Transform transform;
    transform.translation.z = aside;
    scene.nodes.push_back({"aside", kNone, 0, transform, transform});
  }
  frame_camera(scene);
  BakeOptions options;
  options.layout = layout, options.links = Links::threaded, options.width = 32;
  std::vector<Ray> rays;
  std::vector<Known> known;
  for (int quarter = -2; quarter < 4 * (count + 3); quarter += 2)
    for (const bool forth : {true, false}) {
      const float z = 0.25f * static_cast<float>(quarter) + 0.125f;
      const float from = forth ? -4.0f : 4.0f * static_cast<float>(count);
      rays.push_back({{from, 0.0f, aside + z}, {forth ? 1.0f : -1.0f, 0.0f, 0.0f}});
      Known first;
      for (int i = 0; i < count; ++i) {
        const int k = forth ? count - 1 - i : i;  // the first one last
        if (z > static_cast<float>(k) && z < static_cast<float>(k + 3))
          first = {static_cast<std::uint32_t>(k), has_nodes ? 0 : kNone};
      }
      known.push_back(first);
    }
  return of_known(context, (count > 1 ? "waiting" : "waiting_for_one") + std::string(has_nodes ? ".instances" : ""),
                  scene, options, rays, known, bundle);
}

/// A triangle at the end of as many nodes as may stand in one another: such rays go through more loops than Mesa before
/// 23 has for an invocation, and with the way out `inverse` most of all.
MutationOracle deepest(GlContext& context, Layout layout, TransformOut out) {
  Scene scene;
  scene.materials.resize(1);
  scene.positions = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
  scene.triangles.emplace_back().position = {0, 1, 2};
  scene.parts.push_back({"last", 0, 1, 0, 0});
  Transform step;
  step.translation.x = 1.0f;
  for (std::uint32_t n = 0; n < kMaxDepth; ++n)
    scene.nodes.push_back({std::to_string(n), n == 0 ? kNone : n - 1, n + 1 == kMaxDepth ? 0 : kNone, step, step});
  frame_camera(scene);
  const auto x = static_cast<float>(kMaxDepth);
  const std::vector<Ray> rays{{{x + 0.25f, 0.125f, 1.5f}, {0.0f, 0.0f, -1.0f}},
                              {{x + 2.0f, 0.125f, 1.5f}, {0.0f, 0.0f, -1.0f}}};
  BakeOptions options;
  options.layout = layout, options.transform_out = out;
  return of_known(context, std::string("deepest.") + name_of(out), scene, options, rays, {{0, kMaxDepth - 1}, {}});
}

/// Two triangles share an edge along x, `away` along z; rays pass it so near that their y must not be taken for 0.
MutationOracle beside_edge(GlContext& context, const char* name, float size, float away, float beside) {
  Scene scene;
  scene.materials.resize(1);
  scene.positions = {{-size, 0.0f, away}, {size, 0.0f, away}, {0.0f, -size, away}, {0.0f, size, away}};
  scene.triangles.emplace_back().position = {0, 2, 1};
  scene.triangles.emplace_back().position = {0, 1, 3};
  frame_camera(scene);
  std::vector<Ray> rays;
  std::vector<Known> known;
  for (const float y : {beside, 0.0f, -beside}) {
    rays.push_back({{0.25f * size, y, away + size}, {0.0f, 0.0f, -1.0f}});
    known.push_back({y > 0.0f ? 1u : 0u, kNone});
  }
  return of_known(context, name, scene, {}, rays, known);
}

/// An instance so small and sheared that normals come out of it nearly as long as floats reach. Rays along a diagonal
/// pass through its very middle.
MutationOracle smallest_instance(GlContext& context) {
  Scene scene;
  scene.materials.resize(1);
  scene.spheres = {{{0.0f, 4.0f, 0.0f}, 1.0f, 0}, {{0.0f, 0.0f, 0.0f}, 1.0f, 0}};
  scene.parts.push_back({"ball", 0, 0, 1, 1});
  Transform t;
  t.linear = 0x1p-126f * glm::mat3(1.0f, 1.0f, 0.0f, 1.0f, 1.5f, 0.0f, 0.0f, 0.0f, 1.0f);
  scene.nodes.push_back({"smallest", kNone, 0, t, t});
  frame_camera(scene);
  // To them it is a ball of radius 1 some 2^125 away, along an axis.
  const std::vector<Ray> rays{{{-0.5f, -0.5f, 0.0f}, {1.0f, 1.0f, 0.0f}},
                              {{0.5f, 0.5f, 0.0f}, {-1.0f, -1.0f, 0.0f}},
                              {{-0.5f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}}};
  return of_known(context, "smallest_instance", scene, {}, rays, {{1, 0, 0.5f}, {1, 0, 0.5f}, {1, 0, 0.5f}});
}

/// Broken records that take rays where there are no numbers for them, to no direction or to an infinite one: such a ray
/// turns back at the door, and visits the two nodes of the world.
MutationOracle no_numbers(GlContext& context) {
  Scene scene;
  scene.materials.resize(1);
  scene.spheres = {{{0.0f, 0.0f, 0.0f}, 1.0f, 0}};
  scene.parts.push_back({"ball", 0, 0, 0, 1});
  scene.nodes.push_back({"broken", kNone, 0, {}, {}});
  frame_camera(scene);
  const GeometryImage sound = bake(scene);
  auto images = std::make_shared<std::vector<GeometryImage>>(2, sound);
  for (std::uint32_t row = 0; row < 3; ++row)
    for (int a = 0; a < 3; ++a) {
      (*images)[0].texels[transform_texel(sound, 0, row)][a] = 0.0f;
      (*images)[1].texels[transform_texel(sound, 0, row)][a] = 0x1.8p127f;
    }
  const std::vector<Ray> rays{{{0.0f, 0.0f, 0.0f}, {1.0f, 1.0f, 0.5f}}, {{0.0f, 0.0f, 0.0f}, {1.0f, -0.25f, 1.0f}}};
  MutationOracle oracle;
  oracle.name = "no_numbers";
  oracle.programs = lines_of(sound, 1);
  oracle.ask = [&context, images, rays](const Mutant&) -> std::string {
    for (const GeometryImage& image : *images) {
      std::vector<Hit> hits(rays.size());
      Probe(context, image).trace(rays, hits);
      for (const Hit& hit : hits)
        if (hit.kind != HitKind::miss || hit.steps != 2 || hit.transforms != 1)
          return "a ray visits " + std::to_string(hit.steps) + " nodes and enters " + std::to_string(hit.transforms) +
                 " spaces, where there are no numbers";
    }
    return {};
  };
  return oracle;
}

/// A triangle of denormal numbers across rays along z: they are so coarse that where it is hit is known to the last
/// bit.
MutationOracle faint(GlContext& context) {
  static constexpr float kSize = 0x1p-130f, kZ = 0x1.5555p-132f;
  Scene scene;
  scene.materials.resize(1);
  scene.positions = {{-kSize, -kSize, kZ}, {0.9f * kSize, -0.8f * kSize, kZ}, {0.1f * kSize, kSize, kZ}};
  scene.triangles.emplace_back().position = {0, 1, 2};
  frame_camera(scene);
  auto image = std::make_shared<const GeometryImage>(bake(scene));
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 1024; ++i) {
    Random random(kSeed, 3, i);
    const double x = random.uniform(-0.1, 0.1), y = random.uniform(-0.5, 0.0);
    rays.push_back({{kSize * static_cast<float>(x), kSize * static_cast<float>(y), 2.0f * kSize}, {0.0f, 0.0f, -1.0f}});
  }
  MutationOracle oracle;
  oracle.name = "faint";
  oracle.programs = lines_of(*image, 1);
  oracle.ask = [&context, image, rays](const Mutant&) -> std::string {
    std::vector<Hit> hits(rays.size());
    Probe(context, *image).trace(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (hits[i].kind != HitKind::hit || hits[i].position != glm::vec3(rays[i].origin.x, rays[i].origin.y, kZ))
        return "ray " + std::to_string(i) + " does not end where it is in the plane of the triangle";
    return {};
  };
  return oracle;
}

/// A walk that goes on in a cluster does so behind the leaf that it has left, and nowhere else: spheres whose second
/// node, at texel 1, is a leaf, though not that of the first primitive.
MutationOracle second_node(GlContext& context) {
  Scene scene;
  GeometryImage image;
  const auto is_wanted = [&] {
    const auto word = std::bit_cast<std::uint32_t>(image.texels[1].w);
    return word != kEndWord && word >> 31 != 0 && (word & ((1u << image.payload_bits) - 1)) != 0;
  };
  for (std::uint64_t seed = 0; seed == 0 || (!is_wanted() && seed < 1000); ++seed) {
    Random random(kSeed, 2, seed);
    scene = {};
    scene.materials.resize(1);
    for (int i = 0; i < 12; ++i) {
      const float x = random.uniform(), y = random.uniform(), z = random.uniform();
      scene.spheres.push_back({8.0f * glm::vec3(x, y, z), 0.5f, 0});
    }
    frame_camera(scene);
    image = bake(scene);
  }
  PLUMBLINE_ASSERT(is_wanted());
  std::vector<Ray> rays;  // towards each of them, and upwards along all axes
  for (const Sphere& sphere : scene.spheres) rays.push_back({sphere.center - glm::vec3(1.0f), glm::vec3(1.0f)});
  std::vector<Hit> hits(rays.size());
  Probe(context, image, Traversal::brute_force).trace(rays, hits);
  std::vector<Known> known;
  for (const Hit& hit : hits) known.push_back({hit.primitive, hit.instance});
  return of_known(context, "second_node", scene, {}, rays, known);
}

/// An image whose first node is never met and leads to itself: every ray goes round there until it is told to stop.
GeometryImage endless_image(const Scene& scene, const BakeOptions& options) {
  GeometryImage image = bake(scene, options);
  PLUMBLINE_ASSERT(image.copy_count == 1);
  glm::vec4* texels = image.texels.data();
  // No payload: the distance to the next node is 0.
  const std::uint32_t word = std::bit_cast<std::uint32_t>(1e-30f) >> image.payload_bits << image.payload_bits;
  texels[0] = glm::vec4(image.center + 0.5f * image.radius, std::bit_cast<float>(word));
  if (options.layout == Layout::paper) {
    glm::vec4& links = texels[image.width];
    links.z = 0.5f / static_cast<float>(image.width), links.w = 0.5f / static_cast<float>(image.height);
  }
  return image;
}

/// Rays whose walks never end visit as many nodes as the longest walk may, test nothing, and say so.
MutationOracle endless(GlContext& context, bool has_nodes, Layout layout) {
  BakeOptions options;
  options.layout = layout, options.links = Links::threaded, options.width = 32;
  auto image = std::make_shared<const GeometryImage>(endless_image(grids(has_nodes), options));
  std::vector<Ray> rays;
  for (int i = 0; i < 256; ++i) {
    Random random(kSeed, 1, static_cast<std::uint64_t>(i));
    const glm::vec3 direction(random.direction());
    rays.push_back({image->center - (0.5f + 0.01f * static_cast<float>(i)) * image->radius * direction, direction});
  }
  const std::uint32_t steps = image->cell_count + (layout == Layout::paper && has_nodes ? 1u : 0u);
  MutationOracle oracle;
  oracle.name = std::string("endless.") + name_of(layout) + (has_nodes ? ".instances" : "");
  oracle.programs = {active_lines(probe_vertex_shader()),
                     active_lines(probe_fragment_shader(program_variant(*image, false, false)))};
  oracle.ask = [&context, image, rays, steps](const Mutant&) -> std::string {
    std::vector<Hit> hits(rays.size());
    Probe(context, *image).trace(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (hits[i].kind != HitKind::capped || hits[i].steps != steps || hits[i].primitive_tests != 0 ||
          hits[i].transforms != 0)
        return "ray " + std::to_string(i) + " does not stop after " + std::to_string(steps) + " nodes, but after " +
               std::to_string(hits[i].steps);
    return {};
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> tie_oracles(GlContext& context) {
  std::vector<MutationOracle> oracles{second_node(context), smallest_instance(context), no_numbers(context),
                                      faint(context)};
  oracles.push_back(deepest(context, Layout::compact, TransformOut::restore));
  for (const Layout layout : {Layout::compact, Layout::paper})
    oracles.push_back(deepest(context, layout, TransformOut::inverse));
  // Beside the edge of a scene as small as is walked as it is, and of one as far from the origin as its numbers allow.
  oracles.push_back(beside_edge(context, "beside_edge.small", 0x1.8p-20f, 0.0f, 0x1.8p-42f));
  oracles.push_back(beside_edge(context, "beside_edge.far", 1.0f, 0x1p18f, 0x1p-44f));
  for (const bool has_nodes : {false, true})
    for (const Layout layout : {Layout::compact, Layout::paper}) {
      // One copy of the tree: then fewer texels stand before the primitives than there are primitives.
      oracles.push_back(ties(context, has_nodes, layout, Links::threaded));
      oracles.push_back(waiting(context, 1, has_nodes, layout, 1));
      oracles.push_back(endless(context, has_nodes, layout));
    }
  oracles.push_back(ties(context, false, Layout::compact, Links::threaded, 2));
  oracles.push_back(waiting(context, 3, false, Layout::compact, 1));
  for (const int bundle : {2, 3}) oracles.push_back(waiting(context, 1, false, Layout::compact, bundle));
  return oracles;
}

}  // namespace plumbline
