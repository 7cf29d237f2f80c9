// SPDX-License-Identifier: MIT
// The production shader against brute force, bit for bit, and against double precision, within derived bounds.
#include "tracer/probe.h"
#include "tracer/pass.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "scenes/rays.h"
#include "tracer/probe_test_judge.h"
#include "tracer/verify.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

GlContext& context() {
  static GlContext instance;
  return instance;
}

std::vector<Hit> traced(Probe& probe, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  probe.trace(rays, hits);
  return hits;
}
std::vector<Hit> traced(const GeometryImage& image, const std::vector<Ray>& rays,
                        Traversal traversal = Traversal::tree) {
  Probe probe(context(), image, traversal);
  return traced(probe, rays);
}

/// Whether two hits are the same in every bit of the answer; how much work it was may differ.
bool same_answer(Hit a, Hit b) {
  a.steps = b.steps = a.primitive_tests = b.primitive_tests = 0;
  return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}
std::size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += !same_answer(a[i], b[i]);
  return n;
}

/// `per_family` rays of every family, the nasty ones included.
std::vector<Ray> rays_of_all_families(const Scene& scene, std::size_t per_family, std::uint64_t seed = 1) {
  const SphereTree tree = build_sphere_tree(scene);
  std::vector<glm::vec4> spheres;
  for (const TreeNode& node : tree.nodes) spheres.emplace_back(node.center, node.radius);
  const RaySource source(scene, spheres);
  std::vector<Ray> all;
  for (const RayFamilyInfo& info : ray_families()) {
    std::vector<Ray> rays(per_family);
    generate_rays(source, info.family, seed, 0, rays);
    all.insert(all.end(), rays.begin(), rays.end());
  }
  return all;
}

/// Random triangles and spheres of many sizes in a box, some triangles long and thin.
Scene soup(std::uint32_t triangles, std::uint32_t spheres, std::uint64_t seed) {
  Scene scene;
  scene.name = "soup";
  scene.materials.emplace_back();
  for (std::uint32_t i = 0; i < triangles; ++i) {
    Random random(seed, 1, i);
    const glm::dvec3 center(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const double size = std::exp2(random.uniform(-9.0, 0.0));
    const double thin = i % 4 == 0 ? std::exp2(random.uniform(-20.0, 0.0)) : 1.0;
    const glm::dvec3 along = random.direction() * size, across = random.direction() * (size * thin);
    Triangle triangle;
    for (int k = 0; k < 3; ++k) {
      triangle.position[k] = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.emplace_back(center + (k == 1 ? along : k == 2 ? along * 0.4 + across : glm::dvec3(0.0)));
    }
    scene.triangles.push_back(triangle);
  }
  for (std::uint32_t i = 0; i < spheres; ++i) {
    Random random(seed, 2, i);
    Sphere sphere;
    sphere.center = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    sphere.radius = static_cast<float>(std::exp2(random.uniform(-9.0, -1.0)));
    scene.spheres.push_back(sphere);
  }
  return scene;
}

std::vector<Ray> random_rays(const Ball& ball, double distance, std::size_t count, std::uint64_t seed) {
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    Random random(seed, 3, i);
    const glm::dvec3 from = ball.center + random.direction() * (ball.radius * distance);
    const glm::dvec3 at = ball.center + random.direction() * (ball.radius * random.uniform());
    rays[i].origin = glm::vec3(from);
    rays[i].direction = glm::vec3((at - glm::dvec3(rays[i].origin)) * random.uniform(0.5, 2.0));
  }
  return rays;
}

/// Judges every hit in double precision; the number of rays that are wrong beyond rounding.
std::size_t misjudged(const Scene& scene, const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
  const Judge judge(scene);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::string finding = judge.fault_of(rays[i], hits[i]);
    if (finding.empty()) continue;
    if (wrong++ < 3) UNSCOPED_INFO("ray " << i << ": " << finding);
  }
  return wrong;
}

}  // namespace

TEST_CASE("every variant answers as brute force does, bit for bit", "[probe]") {
  std::vector<Scene> scenes{generate_scene("creature"), generate_scene("sphereflake", 2), soup(300, 100, 5),
                            generate_scene("tetra", 3)};
  std::vector<std::vector<Ray>> rays;
  std::vector<std::vector<Hit>> truth;
  Probe brute_force(context(), bake(scenes[0]), Traversal::brute_force);
  for (const Scene& scene : scenes) {
    rays.push_back(rays_of_all_families(scene, 192));
    brute_force.set_image(bake(scene));
    truth.push_back(traced(brute_force, rays.back()));
  }
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
      std::unique_ptr<Probe> probe;
      for (const Links links : {Links::octant, Links::threaded}) {
        for (const int leaf_size : {4, 1, 8}) {
          BakeOptions options;
          options.layout = layout, options.bounds = bounds, options.links = links, options.tree.leaf_size = leaf_size;
          options.tree.width = leaf_size == 1 ? 2 : 0;
          options.tree.split_long = leaf_size == 8 ? 0.2f : 0.0f;
          options.width = leaf_size == 1 ? 64 : 512;
          for (std::size_t s = 0; s < scenes.size(); ++s) {
            const GeometryImage image = bake(scenes[s], options);
            if (!probe) probe = std::make_unique<Probe>(context(), image);
            probe->set_image(image);
            INFO(scenes[s].name << " " << name_of(layout) << " " << name_of(bounds) << " " << name_of(links) << " leaf "
                                << leaf_size);
            CHECK(differences(traced(*probe, rays[s]), truth[s]) == 0);
          }
        }
      }
    }
  }
}

TEST_CASE("hits are right in double precision, within rounding", "[probe]") {
  for (const std::uint64_t seed : {1u, 2u}) {
    const Scene scene = soup(150, 50, seed);
    for (const double distance : {0.3, 1.5, 3.0, 30.0}) {
      const auto rays = random_rays(bounding_ball(scene), distance, 2000, seed);
      INFO("seed " << seed << ", from " << distance << " radii");
      CHECK(misjudged(scene, rays, traced(bake(scene), rays)) == 0);
    }
  }
}

TEST_CASE("far rays are moved near the scene without losing precision", "[probe]") {
  const Scene scene = soup(150, 50, 9);
  const GeometryImage image = bake(scene);
  for (const double distance : {1e3, 1e5, 1e7}) {
    const auto rays = random_rays(bounding_ball(scene), distance, 2000, 4);
    INFO("from " << distance << " radii");
    const auto hits = traced(image, rays);
    CHECK(misjudged(scene, rays, hits) == 0);
    CHECK(differences(hits, traced(image, rays, Traversal::brute_force)) == 0);
  }
  // At the end of what floats can hold: along an axis the ray is exact.
  Ray ray;
  ray.origin = {-3e38f, scene.spheres[0].center.y, scene.spheres[0].center.z};
  ray.direction = {1e30f, 0.0f, 0.0f};
  const auto hits = traced(image, {ray});
  REQUIRE(hits[0].kind == HitKind::hit);
  CHECK(hits[0].t == Approx(3e8).epsilon(1e-6));
}

// Floats hold few lines that start beyond 10^8 radii and still meet the scene: those through the world's origin, from
// which a power of two times the direction takes nothing. Moving such a ray near takes several steps, since each misses
// its aim by 2^-21 of its length; the line is the same as from near by, and so is the hit.
TEST_CASE("rays from as far as floats reach hit as from near by", "[probe]") {
  const Scene scene = soup(150, 50, 9);
  const GeometryImage image = bake(scene);
  std::vector<Ray> near(2000);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const glm::vec3 direction(Random(5, 3, i).direction());
    near[i] = {-8.0f * direction, direction};
  }
  const std::vector<Hit> expected = traced(image, near);
  const auto hit = [](const Hit& h) { return h.kind == HitKind::hit; };
  REQUIRE(std::count_if(expected.begin(), expected.end(), hit) > 500);
  const auto from = [&](int power) {
    std::vector<Ray> rays = near;
    for (Ray& ray : rays) ray.origin *= std::ldexp(1.0f, power - 3);
    return rays;
  };
  const auto apart = [&](const std::vector<Hit>& hits) {
    std::size_t differing = 0;
    for (std::size_t i = 0; i < hits.size(); ++i)
      differing += hits[i].kind != expected[i].kind || hits[i].primitive != expected[i].primitive;
    return differing;
  };
  for (const int power : {20, 40, 60, 80, 100, 124}) {
    const std::vector<Hit> hits = traced(image, from(power));
    double largest = 0.0;
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hit(hits[i]) && hit(expected[i]))
        largest = std::max(largest, static_cast<double>(glm::length(hits[i].position - expected[i].position)));
    INFO("from 2^" << power << ", places apart " << largest);
    CHECK(apart(hits) == 0);
    // The origin near the scene is off by some 2^-22 radii; where a ray grazes a sphere, that moves the hit by up to
    // sqrt(2 * 2^-22) = 2^-10.5 radii.
    CHECK(largest < 0x1p-10 * bounding_ball(scene).radius);
  }
  // From 2^124 four steps after the first are not enough.
  const auto with_steps = [&](const char* steps) {
    const std::array patches{
        ShaderPatch{"ray_prepare.glsl", "for (; rounds < 8", std::string("for (; rounds < ") + steps}};
    Probe probe(context(), image, Traversal::tree, patches);
    return apart(traced(probe, from(124)));
  };
  CHECK(with_steps("4") > 0);
}

TEST_CASE("a fault in the shader is seen by the judge and by brute force", "[probe]") {
  const Scene scene = soup(150, 50, 1);
  const auto rays = random_rays(bounding_ball(scene), 1.5, 1000, 1);
  const GeometryImage image = bake(scene);
  const auto with = [&](ShaderPatch patch) {
    const std::array<ShaderPatch, 1> patches{std::move(patch)};
    Probe probe(context(), image, Traversal::tree, patches);
    return traced(probe, rays);
  };
  CHECK(misjudged(scene, rays, with({"candidate.glsl", "t < nearest.t ||", "t > nearest.t ||"})) > 0);
  CHECK(misjudged(scene, rays, with({"triangle.glsl", "vec2(v, w) * inverse", "vec2(w, v) * inverse"})) > 0);
  CHECK(misjudged(scene, rays, with({"sphere.glsl", "radius * radius - dot", "1.0001 * radius * radius - dot"})) > 0);
  const auto truth = traced(image, rays, Traversal::brute_force);
  CHECK(differences(truth, with({"walk_compact.glsl", "distance2 <= -node.w", "distance2 <= -0.9 * node.w"})) > 0);
}

TEST_CASE("rays without an answer are undefined, in every layout", "[probe]") {
  const Scene scene = soup(50, 20, 3);
  const RaySource source(scene);
  std::vector<Ray> rays(500);
  generate_rays(source, RayFamily::undefined, 1, 0, rays);
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    BakeOptions options;
    options.layout = layout;
    std::size_t undefined = 0;
    for (const Hit& hit : traced(bake(scene, options), rays))
      undefined += hit.kind == HitKind::undefined && hit.primitive == kNone;
    CHECK(undefined == rays.size());
  }
}

TEST_CASE("an empty scene is missed", "[probe]") {
  std::vector<Ray> rays(100);
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    BakeOptions options;
    options.layout = layout;
    std::size_t missed = 0;
    for (const Hit& hit : traced(bake(Scene{}, options), rays)) missed += hit.kind == HitKind::miss;
    CHECK(missed == rays.size());
  }
}

TEST_CASE("the interval is open at zero and closed at t_max", "[probe]") {
  Scene scene;
  scene.materials.emplace_back();
  scene.positions = {{-8, -8, 2}, {8, -8, 2}, {0, 8, 2}};
  scene.triangles.push_back({{0, 1, 2}});
  scene.spheres.push_back({{0, 0, -4}, 1.0f, 0});
  const auto t_of = [&](float origin_z, float direction_z, float t_max) {
    Ray ray;
    ray.origin = {0, 0, origin_z}, ray.direction = {0, 0, direction_z}, ray.t_max = t_max;
    const Hit hit = traced(bake(scene), {ray})[0];
    return hit.kind == HitKind::hit ? hit.t : -1.0f;
  };
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  CHECK(t_of(0, 1, kInfinity) == 2.0f);
  CHECK(t_of(0, 1, 2.0f) == 2.0f);
  CHECK(t_of(0, 1, std::nextafter(2.0f, 0.0f)) == -1.0f);
  CHECK(t_of(0, 4, 0.5f) == 0.5f);
  CHECK(t_of(0, 1, 0.0f) == -1.0f);
  CHECK(t_of(0, 1, -1.0f) == -1.0f);
  CHECK(t_of(2, 1, kInfinity) == -1.0f);   // on the triangle, leaving
  CHECK(t_of(2, -1, kInfinity) == 5.0f);   // on the triangle, towards the sphere
  CHECK(t_of(-4, -1, kInfinity) == 1.0f);  // inside the sphere
  CHECK(t_of(-3, -1, kInfinity) == 2.0f);  // on the sphere, through it
  CHECK(t_of(-3, -1, 2.0f) == 2.0f);
  CHECK(t_of(-3, -1, 1.99f) == -1.0f);
  // Directions whose squares have no float, and t beyond: exact powers of two keep every bit.
  CHECK(t_of(0, 0x1p-140f, kInfinity) == kInfinity);
  CHECK(t_of(0, 0x1p-120f, kInfinity) == 0x1p121f);
  CHECK(t_of(0, 0x1p-120f, 0x1p121f) == 0x1p121f);
  CHECK(t_of(0, 0x1p-120f, 0x1.fffffep120f) == -1.0f);
  CHECK(t_of(0, 0x1p127f, kInfinity) == 0x1p-126f);
  CHECK(t_of(1.5f, 0x1p127f, kInfinity) == 0x1p-128f);  // a denormal
  CHECK(t_of(1.5f, 0x1p127f, 0x1p-128f) == 0x1p-128f);
}

TEST_CASE("a walk whose last triangle is seen edge-on ends", "[probe]") {
  Scene scene;
  scene.materials.emplace_back();
  scene.positions = {{0, -1, -1}, {0, 1, -1}, {0, 0, 1}};
  scene.triangles.push_back({{0, 1, 2}});
  Ray within, beside;  // in the triangle's plane, through it and past it
  within.origin = {0, 0, -3}, within.direction = {0, 0, 1};
  beside.origin = {0, 2, -3}, beside.direction = {0, 0, 1};
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    BakeOptions options;
    options.layout = layout;
    const GeometryImage image = bake(scene, options);
    INFO("layout " << name_of(layout));
    for (const Hit& hit : traced(image, {within, beside})) {
      CHECK(hit.kind == HitKind::miss);
      CHECK(hit.steps <= image.cell_count);
      CHECK(hit.primitive_tests <= 1);
    }
  }
}

TEST_CASE("components of any smallness are harmless", "[probe]") {
  // Corners with coordinates of 0 or nearly, in planes of the axes: there small components meet nothing that outweighs
  // them.
  Scene scene = soup(100, 50, 6);
  for (std::uint32_t i = 0; i < 200; ++i) {
    Random random(6, 5, i);
    Triangle triangle;
    for (int k = 0; k < 3; ++k) {
      triangle.position[k] = static_cast<std::uint32_t>(scene.positions.size());
      glm::vec3 corner(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      corner[i % 3] = i % 2 == 0 ? 0.0f : std::ldexp(corner[i % 3], -static_cast<int>(random.below(140)));
      if (k == 0) corner[(i + 1) % 3] = 0.0f;
      scene.positions.push_back(corner);
    }
    scene.triangles.push_back(triangle);
  }
  const GeometryImage image = bake(scene);
  auto rays = random_rays(bounding_ball(scene), 1.5, 4000, 12);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Random random(6, 4, i);
    Ray& ray = rays[i];
    for (int axis = 0; axis < 3; ++axis) {
      const int origin_shift = static_cast<int>(random.below(150)),
                direction_shift = static_cast<int>(random.below(150));
      if (random.below(2) == 0) ray.origin[axis] = std::ldexp(ray.origin[axis], -origin_shift);
      // One component stays, so that t has a float.
      if (random.below(2) == 0 && axis != static_cast<int>(i % 3))
        ray.direction[axis] = std::ldexp(ray.direction[axis], -direction_shift);
    }
  }
  const auto hits = traced(image, rays);
  CHECK(misjudged(scene, rays, hits) == 0);
  CHECK(differences(hits, traced(image, rays, Traversal::brute_force)) == 0);
}

TEST_CASE("among equal distances the lowest primitive number wins, in any order of storage", "[probe]") {
  Scene scene;
  scene.materials.emplace_back();
  scene.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  for (int i = 0; i < 20; ++i) scene.triangles.push_back({{0, 1, 2}});
  for (int i = 0; i < 20; ++i) scene.spheres.push_back({{0, 0, 1}, 1.0f, 0});  // touch the triangles at the origin
  Ray ray;
  ray.origin = {0, 0, -1};
  for (const int leaf_size : {1, 4, 8}) {
    BakeOptions options;
    options.tree.leaf_size = leaf_size;
    const Hit hit = traced(bake(scene, options), {ray})[0];
    CHECK(hit.t == 1.0f);
    CHECK(hit.primitive == 0);
  }
}

TEST_CASE("a scene times a power of two gives the same answers", "[probe]") {
  const Scene scene = soup(100, 50, 11);
  auto rays = random_rays(bounding_ball(scene), 1.5, 1000, 2);
  const auto plain = traced(bake(scene), rays);
  for (const int exponent : {-90, 90}) {
    const float factor = std::ldexp(1.0f, exponent);
    Scene scaled = scene;
    for (glm::vec3& p : scaled.positions) p *= factor;
    for (Sphere& s : scaled.spheres) s.center *= factor, s.radius *= factor;
    auto scaled_rays = rays;
    for (Ray& ray : scaled_rays) ray.origin *= factor;
    auto hits = traced(bake(scaled), scaled_rays);
    for (Hit& hit : hits) {
      if (hit.kind != HitKind::hit) continue;
      hit.t /= factor, hit.position /= factor;
    }
    INFO("times 2^" << exponent);
    CHECK(differences(plain, hits) == 0);
  }
}

TEST_CASE("walks longer than the driver's loops go on in further passes", "[probe]") {
  // A ray beside a long row of small spheres: near enough to enter every node, too far to hit a sphere.
  Scene scene;
  scene.materials.emplace_back();
  constexpr int kSpheres = 110'000;
  for (int i = 0; i < kSpheres; ++i) scene.spheres.push_back({{static_cast<float>(i), 0.0f, 0.0f}, 0.125f, 0});
  BakeOptions options;
  options.tree.leaf_size = 1;
  options.tree.width = 2;
  options.links = Links::threaded;
  Ray beside, first, last;
  beside.origin = {-1.0f, 0.1875f, 0.0f}, beside.direction = {1.0f, 0.0f, 0.0f};
  first.origin = {-1.0f, 0.0f, 0.0f}, first.direction = {1.0f, 0.0f, 0.0f};
  last.origin = {-1.0f, 0.25f, 0.0f}, last.direction = {static_cast<float>(kSpheres), -0.25f, 0.0f};
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    options.layout = layout;
    Probe probe(context(), bake(scene, options));
    const auto hits = traced(probe, {beside, first, last, beside});
    INFO("layout " << name_of(layout));
    CHECK(hits[0].kind == HitKind::miss);
    CHECK(hits[0].steps > 200'000);
    CHECK(hits[0].primitive_tests == kSpheres);
    CHECK(same_answer(hits[0], hits[3]));
    CHECK(hits[0].steps == hits[3].steps);
    CHECK(hits[1].kind == HitKind::hit);
    CHECK(hits[1].primitive == 0);
    CHECK(hits[2].kind == HitKind::hit);
    CHECK(hits[2].primitive > kSpheres / 3);
    if (context().version().find("Mesa 22.3") != std::string::npos) CHECK(probe.resumed_passes() > 0);
  }
}

TEST_CASE("a link in a circle ends as capped, not as a miss and not never", "[probe]") {
  const Scene scene = generate_scene("creature");
  Ray ray;  // beside the scene, so that the root's way out is taken
  const Ball ball = bounding_ball(scene);
  ray.origin = glm::vec3(ball.center + glm::dvec3(0.999 * ball.radius, 0.999 * ball.radius, 0.0));
  BakeOptions options;
  options.links = Links::threaded;
  GeometryImage compact = bake(scene, options);
  compact.texels[0] =
      glm::vec4(1e6f, 0.0f, 0.0f, std::bit_cast<float>(kWordBase));  // a payload of 0: the next node is this one
  CHECK_FALSE(certify(compact).is_sound());
  CHECK(traced(compact, {ray})[0].kind == HitKind::capped);

  options.layout = Layout::paper;
  GeometryImage paper = bake(scene, options);
  paper.texels[0] = glm::vec4(1e6f, 0.0f, 0.0f, 1.0f);
  glm::vec4& links = paper.texels[static_cast<std::size_t>(paper.width)];
  links.z = 0.5f / static_cast<float>(paper.width), links.w = 0.5f / static_cast<float>(paper.height);
  CHECK_FALSE(certify(paper).is_sound());
  CHECK(traced(paper, {ray})[0].kind == HitKind::capped);
}

TEST_CASE("a ray's answer does not depend on its company", "[probe]") {
  const Scene scene = soup(200, 100, 21);
  const auto some = rays_of_all_families(scene, 40);
  std::vector<Ray> many;  // more than a batch, each ray several times in different neighbourhoods
  for (std::size_t i = 0; many.size() < 300'000; ++i) many.push_back(some[(i * 7919) % some.size()]);
  Probe probe(context(), bake(scene));
  const auto alone = traced(probe, some), together = traced(probe, many);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < many.size(); ++i) {
    const Hit &a = together[i], &b = alone[(i * 7919) % some.size()];
    wrong += std::memcmp(&a, &b, sizeof(Hit)) != 0;
  }
  CHECK(wrong == 0);
  CHECK(probe.draw_seconds() > 0.0);
  CHECK(traced(probe, {}).empty());
}

TEST_CASE("a probe changes images, and two probes do not disturb one another", "[probe]") {
  const Scene spheres = generate_scene("sphereflake", 2), creature = generate_scene("creature"), both = soup(50, 50, 2);
  const auto rays = random_rays(bounding_ball(both), 1.5, 500, 8);
  Probe a(context(), bake(spheres)), b(context(), bake(creature));
  const auto spheres_first = traced(a, rays), creature_first = traced(b, rays);
  CHECK(differences(spheres_first, creature_first) > 0);
  a.set_image(bake(both));
  const auto both_first = traced(a, rays);
  CHECK(differences(traced(b, rays), creature_first) == 0);
  a.set_image(bake(creature));
  CHECK(differences(traced(a, rays), creature_first) == 0);
  a.set_image(bake(spheres));
  CHECK(differences(traced(a, rays), spheres_first) == 0);
  GlContext other;
  Probe c(other, bake(both));
  CHECK(differences(traced(c, rays), both_first) == 0);
  CHECK(differences(traced(a, rays), spheres_first) == 0);
}

TEST_CASE("an image larger than the driver's textures is refused", "[probe]") {
  BakeOptions paper;
  paper.layout = Layout::paper;
  GeometryImage image = bake(generate_scene("tetra", 2), paper);
  image.width = 2 * context().max_texture_size();
  CHECK_THROWS_WITH(Probe(context(), image), Contains(std::to_string(context().max_texture_size())));
  // A buffer texture that is too long would be cut off by the driver without a word.
  const auto most = static_cast<std::size_t>(context().max_buffer_texels());
  CHECK(most >= 65536);
  CHECK_NOTHROW(require_fitting_texels(context(), most, "it", "use less"));
  CHECK_THROWS_WITH(require_fitting_texels(context(), most + 1, "it", "use less"), Contains(std::to_string(most)));
}
