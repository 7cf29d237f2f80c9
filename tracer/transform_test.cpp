// SPDX-License-Identifier: MIT
// Transforms through the production shader: against brute force, against double precision, and after moves.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "tracer/pass.h"
#include "tracer/probe.h"
#include "tracer/shader_words.h"
#include "tracer/verify.h"

namespace plumbline {
namespace {

GlContext& context() {
  static GlContext shared;
  return shared;
}

/// Appends the geometry of `from` as a part.
std::uint32_t add_part(Scene& scene, const Scene& from, const char* name) {
  Part part;
  part.name = name;
  part.first_triangle = static_cast<std::uint32_t>(scene.triangles.size());
  part.triangle_count = static_cast<std::uint32_t>(from.triangles.size());
  part.first_sphere = static_cast<std::uint32_t>(scene.spheres.size());
  part.sphere_count = static_cast<std::uint32_t>(from.spheres.size());
  const auto base = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), from.positions.begin(), from.positions.end());
  for (const Triangle& t : from.triangles) {
    Triangle copy;
    for (int i = 0; i < 3; ++i) copy.position[i] = base + t.position[i];
    scene.triangles.push_back(copy);
  }
  for (const Sphere& s : from.spheres) scene.spheres.push_back({s.center, s.radius, 0});
  scene.parts.push_back(part);
  return static_cast<std::uint32_t>(scene.parts.size() - 1);
}

Transform random_transform(Random& random, double reach) {
  const glm::dvec3 axis = random.direction();
  glm::dmat3 linear(glm::rotate(glm::dmat4(1.0), random.uniform(0.0, 6.0), axis));
  for (int i = 0; i < 3; ++i) linear[i] *= std::exp2(random.uniform(-1.0, 1.0));
  if (random.below(3) == 0) linear[0] = -linear[0];        // a mirror
  if (random.below(3) == 0) linear[1] += 0.5 * linear[2];  // a shear
  const glm::dvec3 translation = random.direction() * random.uniform(0.0, reach);
  return {glm::mat3(linear), glm::vec3(translation)};
}

std::uint32_t add_node(Scene& scene, std::uint32_t parent, std::uint32_t part, const Transform& transform) {
  Node node;
  node.name = "n" + std::to_string(scene.nodes.size());
  node.parent = parent, node.part = part, node.transform = node.rest = transform;
  scene.nodes.push_back(node);
  return static_cast<std::uint32_t>(scene.nodes.size() - 1);
}

/// Geometry in the world, three parts, and nodes nested up to four deep.
Scene nested_scene(std::uint64_t seed, std::uint32_t instances) {
  Scene scene;
  scene.name = "nested";
  scene.materials.emplace_back();
  const Scene tetra = generate_scene("tetra", 2);
  scene.positions = tetra.positions, scene.triangles = tetra.triangles;
  const std::uint32_t parts[] = {add_part(scene, generate_scene("icosphere", 1), "ball"),
                                 add_part(scene, generate_scene("sphereflake", 1), "flake"),
                                 add_part(scene, generate_scene("cube"), "cube")};
  Random random(seed, 1, 0);
  std::vector<std::uint32_t> groups{kNone};
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t parent = groups[random.below(static_cast<std::uint32_t>(groups.size()))];
    if (parent != kNone && chain_of(scene, parent).size() >= 3) continue;
    groups.push_back(add_node(scene, parent, kNone, random_transform(random, 2.0)));
  }
  for (std::uint32_t i = 0; i < instances; ++i) {
    const std::uint32_t parent = groups[random.below(static_cast<std::uint32_t>(groups.size()))];
    add_node(scene, parent, parts[random.below(3)], random_transform(random, 4.0));
  }
  return scene;
}

std::vector<Ray> random_rays(const Scene& scene, std::size_t count, std::uint64_t seed) {
  const Ball ball = bounding_ball(scene);
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    Random random(seed, 3, i);
    const double distance = i % 5 == 0 ? 1e4 : i % 5 == 1 ? 0.3 : 1.5;
    rays[i].origin = glm::vec3(ball.center + random.direction() * (ball.radius * distance));
    const glm::dvec3 at = ball.center + random.direction() * (ball.radius * random.uniform());
    rays[i].direction = glm::vec3((at - glm::dvec3(rays[i].origin)) * random.uniform(0.5, 2.0));
    if (i % 7 == 0) rays[i].t_max = static_cast<float>(random.uniform(0.0, 2.0));
  }
  return rays;
}

bool same_answer(Hit a, Hit b) {
  a.steps = b.steps = a.primitive_tests = b.primitive_tests = a.transforms = b.transforms = 0;
  return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}

std::size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += !same_answer(a[i], b[i]);
  return n;
}

/// A hit in double precision, by all pairs of instance and primitive. `clear` is false where rounding could change it.
struct Truth {
  bool hit = false, clear = true;
  std::uint32_t instance = kNone, primitive = kNone;
  double t = INFINITY;
  glm::dvec3 position{0.0}, normal{0.0};
};

/// The meetings with one primitive in its own space, nearest first; `margin` is how clear they are, relative.
void meet(const Scene& scene, std::uint32_t p, const glm::dvec3& o, const glm::dvec3& d, double t_max, double& t,
          double& margin, glm::dvec3& normal) {
  t = INFINITY, margin = INFINITY;
  if (scene.is_triangle(p)) {
    const auto v = scene.corners(p);
    const glm::dvec3 a(v[0]), e = glm::dvec3(v[1]) - a, f = glm::dvec3(v[2]) - a;
    normal = glm::cross(e, f);
    const double det = glm::dot(normal, d), length = glm::length(normal) * glm::length(d);
    if (!(std::abs(det) > 1e-3 * length)) {
      margin = 0.0;  // edge-on: nothing is clear where the line passes close by
      const glm::dvec3 m = a - o;
      const double off = glm::length(m - glm::dot(m, d) / glm::dot(d, d) * d);
      if (off > glm::length(e) + glm::length(f)) margin = INFINITY;
      return;
    }
    const double at = glm::dot(normal, a - o) / det;
    const glm::dvec3 q = o + at * d - a;
    const double w1 = glm::dot(glm::cross(q, f), normal) / glm::dot(normal, normal);
    const double w2 = glm::dot(glm::cross(e, q), normal) / glm::dot(normal, normal);
    const double least = std::min({w1, w2, 1.0 - w1 - w2});
    margin = std::min({std::abs(least), std::abs(at), std::abs(t_max - at)});
    if (least >= 0.0 && at > 0.0 && at <= t_max) t = at;
    return;
  }
  const Sphere& s = scene.sphere(p);
  const glm::dvec3 m = glm::dvec3(s.center) - o;
  const double dd = glm::dot(d, d), foot = glm::dot(m, d) / dd, off = glm::length(m - foot * d) / s.radius;
  margin = std::abs(off - 1.0);
  if (off > 1.0) return;
  const double half = std::sqrt((1.0 - off * off) * s.radius * s.radius / dd);
  for (const double root : {foot - half, foot + half}) {
    margin = std::min({margin, std::abs(root), std::abs(t_max - root)});
    if (t == INFINITY && root > 0.0 && root <= t_max) t = root;
  }
  normal = o + t * d - glm::dvec3(s.center);
}

Truth truth_of(const Scene& scene, const Ray& ray) {
  Truth truth;
  double second = INFINITY;
  std::vector<std::uint32_t> spaces = instances_of(scene);
  spaces.push_back(kNone);
  for (const std::uint32_t instance : spaces) {
    const TransformD out = to_world(scene, instance), in = inverse(out);
    const glm::dvec3 o = transform_point(in, glm::dvec3(ray.origin)), d = in.linear * glm::dvec3(ray.direction);
    for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
      if (!scene.is_placed(instance, p)) continue;
      double t = INFINITY, margin = INFINITY;
      glm::dvec3 normal(0.0);
      meet(scene, p, o, d, ray.t_max, t, margin, normal);
      if (margin < 1e-2) truth.clear = false;
      if (!(t < truth.t)) {
        second = std::min(second, t);
        continue;
      }
      second = truth.t;
      truth = {true,
               truth.clear,
               instance,
               p,
               t,
               glm::dvec3(ray.origin) + t * glm::dvec3(ray.direction),
               glm::normalize(glm::transpose(in.linear) * normal)};
    }
  }
  if (second - truth.t < 1e-3 * truth.t) truth.clear = false;
  return truth;
}

std::vector<Hit> traced(const GeometryImage& image, const std::vector<Ray>& rays,
                        Traversal traversal = Traversal::tree) {
  Probe probe(context(), image, traversal);
  std::vector<Hit> hits(rays.size());
  probe.trace(rays, hits);
  return hits;
}

}  // namespace

TEST_CASE("with transforms, every variant answers as brute force does, bit for bit", "[transform]") {
  for (const std::uint64_t seed : {1ull, 2ull}) {
    const Scene scene = nested_scene(seed, 12);
    const std::vector<Ray> rays = random_rays(scene, 4000, seed);
    const std::vector<Hit> truth = traced(bake(scene), rays, Traversal::brute_force);
    std::size_t hits = 0, in_instances = 0;
    for (const Hit& hit : truth) hits += hit.kind == HitKind::hit, in_instances += hit.instance != kNone;
    CHECK(hits > 800);
    CHECK(in_instances > 400);
    for (const Layout layout : {Layout::compact, Layout::paper})
      for (const Bounds bounds : {Bounds::sphere, Bounds::aabb})
        for (const Links links : {Links::octant, Links::threaded})
          for (const TransformList list : {TransformList::tree, TransformList::root}) {
            BakeOptions options;
            options.layout = layout, options.bounds = bounds, options.links = links, options.transform_list = list;
            const GeometryImage image = bake(scene, options);
            INFO(name_of(layout) << " " << name_of(bounds) << " " << name_of(links) << " " << name_of(list));
            CHECK(certify(image).is_sound());
            CHECK(differences(traced(image, rays), truth) == 0);
          }
  }
}

TEST_CASE("what is hit behind transforms is what double precision says, in either way out", "[transform]") {
  const Scene scene = nested_scene(3, 12);
  const std::vector<Ray> rays = random_rays(scene, 4000, 7);
  for (const TransformOut out : {TransformOut::restore, TransformOut::inverse}) {
    BakeOptions options;
    options.transform_out = out;
    const std::vector<Hit> hits = traced(bake(scene, options), rays);
    std::size_t clear = 0, wrong = 0, mirrored = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Truth truth = truth_of(scene, rays[i]);
      if (!truth.clear) continue;
      ++clear;
      const Hit& hit = hits[i];
      bool right = truth.hit == (hit.kind == HitKind::hit);
      if (truth.hit && right) {
        // Clear hits only: gross mistakes are sought here; the harness bounds each value by its own derivation.
        const double size = bounding_ball(scene).radius;
        right = hit.instance == truth.instance && hit.primitive == truth.primitive &&
                std::abs(hit.t - truth.t) * glm::length(glm::dvec3(rays[i].direction)) < 1e-3 * size &&
                glm::length(glm::dvec3(hit.position) - truth.position) < 1e-3 * size &&
                glm::length(glm::dvec3(hit.normal) - truth.normal) < 1e-2;
        mirrored += truth.instance != kNone && glm::determinant(to_world(scene, truth.instance).linear) < 0.0;
      }
      if (!right && wrong++ < 3) {
        UNSCOPED_INFO("ray " << i << ": (" << hit.instance << ", " << hit.primitive << ") at " << hit.t << " for ("
                             << truth.instance << ", " << truth.primitive << ") at " << truth.t);
      }
    }
    INFO(name_of(out));
    CHECK(clear > 1500);
    CHECK(mirrored > 30);
    CHECK(wrong == 0);
  }
}

TEST_CASE("a node that moves changes its own cells and the spheres above it, as a full bake would", "[transform]") {
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
      Scene scene = nested_scene(5, 30);
      BakeOptions options;
      options.layout = layout, options.bounds = bounds;
      SceneTree tree = build_scene_tree(scene, options.tree);
      GeometryImage image = bake(scene, tree, options);
      Probe probe(context(), image);
      const std::vector<Ray> rays = random_rays(scene, 1000, 11);
      std::vector<Hit> hits(rays.size());
      Random random(9, 9, 9);
      for (int move = 0; move < 40; ++move) {
        const std::uint32_t node = random.below(static_cast<std::uint32_t>(scene.nodes.size()));
        scene.nodes[node].transform = random_transform(random, move == 20 ? 300.0 : 4.0);
        const std::uint32_t moved[] = {node};
        const std::vector<TexelRange> changed = update_transforms(scene, moved, tree, image);
        probe.update(image, changed);
        std::uint64_t texels = 0;
        for (const TexelRange& range : changed) texels += range.count;
        CHECK(probe.texels_uploaded() == texels);
        const GeometryImage anew = bake(scene, options);
        REQUIRE(std::memcmp(anew.texels.data(), image.texels.data(), image.texels.size() * sizeof(glm::vec4)) == 0);
        REQUIRE(anew.center == image.center);
        REQUIRE(anew.radius == image.radius);
        if (move % 10 != 0) continue;
        probe.trace(rays, hits);
        CHECK(differences(hits, traced(anew, rays)) == 0);
      }
    }
}

TEST_CASE("ten thousand nodes: one that moves changes few texels", "[transform]") {
  Scene scene;
  scene.materials.emplace_back();
  const std::uint32_t part = add_part(scene, generate_scene("icosphere", 2), "ball");
  Random random(1, 2, 3);
  for (int i = 0; i < 10000; ++i) add_node(scene, kNone, part, random_transform(random, 200.0));
  SceneTree tree = build_scene_tree(scene);
  GeometryImage image = bake(scene, tree);
  std::uint64_t most = 0;
  for (int move = 0; move < 50; ++move) {
    const std::uint32_t moved[] = {random.below(10000)};
    scene.nodes[moved[0]].transform.translation += glm::vec3(random.direction());
    std::uint64_t texels = 0;
    for (const TexelRange& range : update_transforms(scene, moved, tree, image)) texels += range.count;
    std::uint64_t above = 0;
    for (std::uint32_t i = tree.leaf[moved[0]]; i != kNone; i = tree.groups[0].nodes[i].parent) above += 8;
    CHECK(texels <= 64 + above);
    most = std::max(most, texels);
  }
  WARN("at most " << most << " texels changed");
  CHECK(most > 7);
}

TEST_CASE("transforms nest as deep as the tracer says, and no deeper", "[transform]") {
  Scene scene;
  scene.materials.emplace_back();
  scene.name = "deep";
  const std::uint32_t part = add_part(scene, generate_scene("cube"), "cube");
  std::uint32_t parent = kNone;
  const Transform step{glm::mat3(1.0f), glm::vec3(1.0f, 0.0f, 0.0f)};
  for (std::uint32_t depth = 1; depth < kMaxDepth; ++depth) parent = add_node(scene, parent, kNone, step);
  add_node(scene, parent, part, step);
  const Ray ray{{static_cast<float>(kMaxDepth) + 0.25f, 0.125f, 20.0f}, {0.0f, 0.0f, -1.0f}};
  for (const TransformOut out : {TransformOut::restore, TransformOut::inverse}) {
    BakeOptions options;
    options.transform_out = out;
    const Hit hit = traced(bake(scene, options), {ray})[0];
    REQUIRE(hit.kind == HitKind::hit);
    CHECK(hit.instance == kMaxDepth - 1);
    CHECK(hit.transforms == kMaxDepth);
    CHECK(hit.position.x == ray.origin.x);
  }
  parent = add_node(scene, kMaxDepth - 2, kNone, step);
  add_node(scene, parent, part, step);
  CHECK_THROWS_AS(bake(scene), InputError);
}

// Every node there is was visited, and the walk still had two spaces to leave: layout `paper` called that endless.
TEST_CASE("a walk that visits every node ends in every layout", "[transform]") {
  Scene scene;
  scene.materials.emplace_back();
  Scene ball;
  ball.spheres.push_back({glm::vec3(0.0f), 1.0f, 0});
  const std::uint32_t part = add_part(scene, ball, "ball");
  const Transform step{glm::mat3(1.0f), glm::vec3(1.0f, 0.0f, 0.0f)};
  const std::uint32_t group = add_node(scene, kNone, kNone, step);
  add_node(scene, group, part, step);
  const Ray ray{{2.0f, 0.0f, 5.0f}, {0.0f, 0.0f, -1.0f}};
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const TransformOut out : {TransformOut::restore, TransformOut::inverse}) {
      BakeOptions options;
      options.layout = layout, options.transform_out = out;
      const Hit hit = traced(bake(scene, options), {ray})[0];
      INFO(name_of(layout) << " " << name_of(out));
      CHECK(hit.kind == HitKind::hit);
      CHECK(hit.instance == 1);
    }
}

// A walk left a cluster before its end, at a triangle seen edge-on, and took the rest of it for done in another
// instance of the same part (found by transforms.variants.around_eye).
// The second ray: layout `paper` left an instance while a triangle of it, the last of all, still waited to be resolved.
TEST_CASE("a cluster left early in one instance is whole in the next", "[transform]") {
  const auto [name, ray] = GENERATE(std::pair<const char*, Ray>{"around_eye",
                                                                {{0x1.83c2fp+0f, -0x1.9673d4p+0f, -0x1.b53644p+1f},
                                                                 {0x1.9580b8p-1f, -0x1.0ca17cp-7f, 0x1.388f68p-1f}}},
                                    std::pair<const char*, Ray>{"mirror",
                                                                {{-0x1.ff3a0ap+1f, -0x1.f9ee94p-4f, -0x1.5b3668p+1f},
                                                                 {-0x1.09d78ep-4f, 0x1.f8ca1p-1f, 0x1.3ba86cp-3f}}});
  const Scene scene = load_scene(name);
  const Hit truth = traced(bake(scene), {ray}, Traversal::brute_force)[0];
  REQUIRE(truth.kind == HitKind::hit);
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const Links links : {Links::octant, Links::threaded}) {
      BakeOptions options;
      options.layout = layout, options.links = links;
      CHECK(same_answer(traced(bake(scene, options), {ray})[0], truth));
    }
}

// Every pass then visits the end of the walk once more, and its step was taken for headway: four million passes (two
// cases of a night hung in this).
TEST_CASE("a walk that no pass brings on ends as capped", "[transform]") {
  const Scene scene = load_scene("around_eye");
  const GeometryImage image = bake(scene);
  const std::vector<ShaderPatch> never{{"result.glsl", "complete = complete && node < 0;", "complete = false;"}};
  Probe probe(context(), image, Traversal::tree, never);
  const std::vector<Ray> rays{
      {{0x1.83c2fp+0f, -0x1.9673d4p+0f, -0x1.b53644p+1f}, {0x1.9580b8p-1f, -0x1.0ca17cp-7f, 0x1.388f68p-1f}}};
  std::vector<Hit> hits(1);
  probe.trace(rays, hits);
  CHECK(hits[0].kind == HitKind::capped);
  CHECK(probe.resumed_passes() < 8);
}

// The driver shades whole blocks of pixels, and loops end after 65,535 iterations of any pixel of a block. Beyond a
// pass's rows stands what earlier passes have left there, or nobody: a walk begun from that can go round for ever. (It
// used up the loops by which rays of their blocks leave instances: a night lost 113 rays of `crowd`.)
TEST_CASE("what stands beyond the rows of a pass has no say", "[transform]") {
  const Scene scene = load_scene("crowd");
  const GeometryImage image = bake(scene);
  REQUIRE(image.cell_count > 65535);
  Probe probe(context(), image);
  std::vector<Ray> rays;  // from so far away that another pass brings them near
  for (std::uint32_t i = 0; i < 64; ++i) {
    const glm::vec3 target = scene.nodes[i * 150].transform.translation + glm::vec3(0.0f, 0.1f, 0.0f);
    rays.push_back({target + glm::vec3(0.0f, 1e8f, 0.0f), glm::vec3(0.0f, -1.0f, 0.0f)});
  }
  std::vector<Hit> expected(rays.size()), hits(rays.size());
  probe.trace(rays, expected);
  REQUIRE(probe.resumed_passes() > 0);
  REQUIRE(std::any_of(expected.begin(), expected.end(), [](const Hit& h) { return h.kind == HitKind::hit; }));

  // The texture of states is still bound. In each state a walk stands far beyond the end of the image.
  const GlFunctions& gl = context().use();
  gl.ActiveTexture(GL_TEXTURE0 + kStateUnit);
  const glm::uvec4 unfinished(kWordUnfinished, 0x7f800000u, 0u, 0u), nowhere(0x7ffffff0u, 0u, ~0u, 0u);
  const glm::uvec4 no_hit(std::bit_cast<std::uint32_t>(static_cast<float>(kNoLabel)), 0u, 0u, 0u),
      world(0u, 0u, ~0u, 0u);
  std::vector<glm::uvec4> states;
  for (int i = 0; i < kBatchWidth * (kBatchHeight - 1); ++i)
    states.insert(states.end(), {unfinished, nowhere, no_hit, world});
  gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 1, 4 * kBatchWidth, kBatchHeight - 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                   states.data());
  std::vector<Ray> many(std::size_t{kBatchWidth} * 8);  // and beyond the rays of the next pass, others
  for (std::size_t i = 0; i < many.size(); ++i)
    many[i] = {rays[i % 64].origin * glm::vec3(1, 1e-7f, 1), rays[0].direction};
  std::vector<Hit> of_many(many.size());
  probe.trace(many, of_many);
  probe.trace(rays, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    CAPTURE(i, hits[i].kind == HitKind::capped);
    CHECK(hits[i].kind == expected[i].kind);
    CHECK(hits[i].primitive == expected[i].primitive);
  }
}

}  // namespace plumbline
