// SPDX-License-Identifier: MIT
// Captured walks end in the production's own hits, bit for bit, and tell how they got there.
#include "tracer/walk_trace.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "scenes/generate.h"
#include "scenes/random.h"
#include "scenes/read.h"
#include "tracer/probe.h"
#include "tracer/shader_words.h"
#include "tracer/walk_analysis.h"

using namespace plumbline;

namespace {

GlContext& context() {
  static GlContext instance;
  return instance;
}

std::vector<Ray> some_rays(const Scene& scene, std::size_t count, std::uint64_t seed) {
  const Ball ball = bounding_ball(scene);
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    Random random(seed, 1, i);
    const double distance = i % 4 == 0 ? 3e5 : i % 4 == 1 ? 0.2 : 1.5;
    rays[i].origin = glm::vec3(ball.center + random.direction() * (ball.radius * distance));
    const glm::dvec3 at = ball.center + random.direction() * (ball.radius * 0.7 * random.uniform());
    rays[i].direction = glm::vec3((at - glm::dvec3(rays[i].origin)) * random.uniform(0.5, 2.0));
    if (i % 5 == 4) rays[i].t_max = static_cast<float>(random.uniform(0.0, 2.0));
  }
  return rays;
}

/// Rays along the planes of triangles, which are then seen edge-on.
void add_edge_on(const Scene& scene, std::vector<Ray>& rays) {
  for (std::uint32_t p = 0; p < scene.triangles.size() && p < 200; p += 41) {
    const auto corners = scene.corners(p);
    Ray ray;
    ray.origin = corners[0] - 2.0f * (corners[1] - corners[0]) + 0.3f * (corners[2] - corners[0]);
    ray.direction = corners[1] - corners[0];
    rays.push_back(ray);
  }
}

bool same_bits(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof(Hit)) == 0; }

/// What is wrong with a walk in itself; empty: nothing.
std::string inconsistency(const Walk& walk) {
  if (!walk.driver_agrees) return "pixels disagree";
  if (walk.skipped != 0) return "not all was captured";
  std::uint32_t tests = 0, transforms = 0, last = 0;
  for (std::size_t i = 0; i < walk.steps.size(); ++i) {
    const WalkStep& step = walk.steps[i];
    const std::string at = " at step " + std::to_string(step.number);
    if (step.number != last + (step.again ? 0 : 1)) return "steps are not counted" + at;
    last = step.number;
    if (step.node == kNone) return "outside of the region" + at;
    if (step.next != (i + 1 < walk.steps.size() ? walk.steps[i + 1].cell : kNone)) return "wrong next cell" + at;
    for (const TestedPrimitive& tested : step.primitives) {
      tests += !tested.resolved;
      if (tested.primitive == kNone) return "a primitive without a number" + at;
      if (tested.nearest_after != tested.nearest_before && tested.outcome != PrimitiveTest::new_nearest)
        return "the nearest hit changed" + at;
    }
    for (const SpaceChange& change : step.changes)
      transforms += change.kind == SpaceChange::Kind::entered || change.kind == SpaceChange::Kind::missed;
  }
  if (last != walk.hit.steps) return std::to_string(walk.hit.steps - last) + " steps are missing";
  if (tests != walk.hit.primitive_tests) return "tests are missing";
  if (transforms != walk.hit.transforms) return "transforms are missing";
  if (!walk.steps.empty() && walk.steps.back().ended != (walk.hit.kind != HitKind::capped)) return "no end";
  return {};
}

/// All combinations of layout and bounds come in turn, with either kind of links and way out.
BakeOptions variant(std::size_t i) {
  BakeOptions options;
  options.layout = i % 2 == 0 ? Layout::compact : Layout::paper;
  options.bounds = i / 2 % 2 == 0 ? Bounds::sphere : Bounds::aabb;
  options.links = i % 3 == 0 ? Links::threaded : Links::octant;
  options.transform_out = i % 3 == 1 ? TransformOut::inverse : TransformOut::restore;
  return options;
}

}  // namespace

TEST_CASE("a captured walk ends in the production's hit, bit for bit", "[walk]") {
  std::size_t pieces = 0, again = 0, resolved = 0, left = 0, resumed = 0, kinds[4] = {};
  std::size_t next_variant = 0;
  for (const char* name : {"creature", "nested", "figure_1", "far_away", "nested", "sphereflake:2"}) {
    const Scene scene = load_scene(name);
    std::vector<Ray> rays = some_rays(scene, 24, next_variant);
    add_edge_on(scene, rays);
    const BakeOptions options = variant(next_variant++);
    INFO(name << ", " << name_of(options.layout) << ", " << name_of(options.bounds) << ", "
              << name_of(options.transform_out));
    const GeometryImage image = bake(scene, options);
    std::vector<Hit> hits(rays.size());
    Probe(context(), image).trace(rays, hits);
    WalkRecorder recorder(context(), image);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      INFO("ray " << i);
      const Walk walk = recorder.record(rays[i]);
      CHECK(same_bits(walk.hit, hits[i]));
      CHECK(inconsistency(walk) == "");
      ++kinds[static_cast<std::size_t>(walk.hit.kind)];
      if (i % 3 == 0) {  // where passes are cut changes nothing
        const Walk in_pieces = recorder.record(rays[i], kMostEvents, 1 + static_cast<int>(i % 7));
        const auto divergence = first_divergence(walk, in_pieces);
        INFO((divergence ? divergence->what + " at step " + std::to_string(divergence->step) : ""));
        CHECK_FALSE(divergence);
        CHECK(same_bits(walk.hit, in_pieces.hit));
        CHECK(in_pieces.passes >= walk.passes);
        pieces += static_cast<std::size_t>(in_pieces.passes);
      }
      for (const WalkStep& step : walk.steps) {
        again += step.again;
        for (const TestedPrimitive& tested : step.primitives) resolved += tested.resolved;
        for (const SpaceChange& change : step.changes) {
          left += change.kind == SpaceChange::Kind::left;
          resumed += change.kind == SpaceChange::Kind::resumed;
        }
      }
    }
  }
  CHECK(kinds[static_cast<std::size_t>(HitKind::hit)] > 40);
  CHECK(kinds[static_cast<std::size_t>(HitKind::miss)] > 40);
  CHECK(pieces > 300);
  CHECK(again > 0);
  CHECK(resolved > 0);
  CHECK(left > 0);
  CHECK(resumed > 0);
}

TEST_CASE("what a step says of its node follows from texels and ray", "[walk]") {
  const Scene scene = load_scene("creature");
  for (const std::size_t i : {0, 1, 2, 3}) {
    const BakeOptions options = variant(i);
    const GeometryImage image = bake(scene, options);
    WalkRecorder recorder(context(), image);
    std::size_t met[6] = {}, wrong = 0;
    for (const Ray& ray : some_rays(scene, 16, 5)) {
      const Walk walk = recorder.record(ray);
      const glm::dvec3 o(walk.start.ray.o), d(walk.start.ray.d);
      for (const WalkStep& step : walk.steps) {
        ++met[static_cast<std::size_t>(step.test)];
        const glm::vec4 texel = image.texels[static_cast<std::size_t>(step.y * image.width + step.x)];
        if (step.test == NodeTest::end) continue;
        wrong += !(step.word == texel.w);
        if (options.bounds == Bounds::aabb) {
          wrong += (step.test == NodeTest::hit) != (std::max(step.enter, 0.0f) <= std::min(step.leave, step.bound));
          continue;
        }
        // In double: the shader's distance is off by less than the padding that bake.h derives.
        const glm::dvec3 m = glm::dvec3(texel) - o;
        const double t = std::clamp(glm::dot(m, d) / glm::dot(d, d), 0.0, static_cast<double>(step.bound));
        wrong += !(std::abs(std::sqrt(step.distance2) - glm::length(m - t * d)) <= 0x1p-17 * image.radius);
        wrong += !(step.radius2 == std::fabs(texel.w));
        wrong += (step.test == NodeTest::hit) != (step.distance2 <= step.radius2);
      }
    }
    CHECK(wrong == 0);
    CHECK(met[static_cast<std::size_t>(NodeTest::hit)] > 0);
    CHECK(met[static_cast<std::size_t>(NodeTest::missed)] > 0);
    CHECK(met[static_cast<std::size_t>(NodeTest::behind)] > 0);
    CHECK(met[static_cast<std::size_t>(NodeTest::beyond)] > 0);
    CHECK((met[static_cast<std::size_t>(NodeTest::end)] > 0) == (options.layout == Layout::compact));
  }
}

TEST_CASE("walks longer than a pass and than the driver's loops are captured to their end", "[walk]") {
  // A ray beside a long row of small spheres: near enough to enter every node, too far to hit a sphere.
  Scene scene;
  scene.materials.emplace_back();
  constexpr std::uint32_t kSpheres = 34'000;
  for (std::uint32_t i = 0; i < kSpheres; ++i)
    scene.spheres.push_back({{static_cast<float>(i), 0.0f, 0.0f}, 0.125f, 0});
  BakeOptions options;
  options.tree.leaf_size = 1;
  options.tree.width = 2;
  options.links = Links::threaded;
  Ray ray;
  ray.origin = {-1.0f, 0.1875f, 0.0f}, ray.direction = {1.0f, 0.0f, 0.0f};
  const GeometryImage image = bake(scene, options);
  std::array<Hit, 1> hit;
  Probe(context(), image).trace(std::array<Ray, 1>{ray}, hit);
  WalkRecorder recorder(context(), image);
  const Walk walk = recorder.record(ray);
  CHECK(same_bits(walk.hit, hit[0]));
  CHECK(walk.steps.size() > 65'535);
  CHECK(walk.hit.primitive_tests == kSpheres);
  CHECK(inconsistency(walk) == "");

  const Walk cut = recorder.record(ray, 5000);
  CHECK(same_bits(cut.hit, hit[0]));
  std::size_t events = 1;  // the start
  for (const WalkStep& step : cut.steps) events += 1 + step.primitives.size() + step.changes.size();
  CHECK(events == 5000);
  // Passes that the driver ends are resumed, which is an event too.
  const std::uint64_t rest = 1 + walk.steps.size() + walk.hit.primitive_tests - 5000;
  CHECK(cut.skipped >= rest);
  CHECK(cut.skipped <= rest + static_cast<std::uint64_t>(cut.passes));
}

TEST_CASE("a walk through many transforms goes on from pass to pass with the very ray that it had", "[walk]") {
  // A row of turned and scaled pairs of spheres; rays pass between them, and meet the sphere at its end.
  Scene scene;
  scene.name = "row";
  scene.materials.emplace_back();
  scene.spheres = {{{0.0f, 1.0f, 0.0f}, 0.25f, 0}, {{0.0f, -1.0f, 0.1f}, 0.25f, 0}, {{0.0f, 0.0f, 0.0f}, 1.5f, 0}};
  Part part;
  part.sphere_count = 2;
  scene.parts.push_back(part);
  part.first_sphere = 2, part.sphere_count = 1;
  scene.parts.push_back(part);
  for (std::uint32_t i = 0; i < 400; ++i) {
    Random random(3, 1, i);
    Node node;
    node.name = std::to_string(i);
    node.transform.linear =
        glm::mat3(0.7f, 0.3f * static_cast<float>(random.uniform()), 0.0f, 0.1f, 0.9f, 0.2f, 0.0f, -0.3f, 1.1f);
    node.transform.translation = {3.0f * static_cast<float>(i), 0.0f, 0.0f};
    if (i % 2 == 0) {
      scene.nodes.push_back(node);  // a group, and the part in it
      node.name += "/in", node.parent = static_cast<std::uint32_t>(scene.nodes.size() - 1);
      node.transform.translation = {0.2f, 0.0f, 0.1f};
    }
    node.part = 0;
    scene.nodes.push_back(node);
  }
  scene.nodes.back().part = 1;
  const std::size_t target = scene.nodes.size() - 1;
  scene.nodes.push_back(scene.nodes[1]);  // one that no ray comes near
  scene.nodes.back().name = "beside", scene.nodes.back().parent = kNone;
  scene.nodes.back().transform.translation = {1500.0f, 50.0f, 0.0f};
  for (Node& node : scene.nodes) node.rest = node.transform;
  std::size_t entered = 0;
  for (const TransformOut out : {TransformOut::inverse, TransformOut::restore}) {
    BakeOptions options;
    options.transform_out = out;
    options.layout = out == TransformOut::inverse ? Layout::compact : Layout::paper;
    const GeometryImage image = bake(scene, options);
    std::vector<Ray> rays;
    for (int i = 0; i < 4; ++i) {
      Ray ray;
      ray.origin = {-3.0f, -0.2f + 0.1f * static_cast<float>(i), 0.5f};
      ray.direction = {1.0f, 0.0001f * static_cast<float>(i), -0.0003f};
      rays.push_back(ray);
    }
    std::vector<Hit> hits(rays.size());
    Probe(context(), image).trace(rays, hits);
    WalkRecorder recorder(context(), image);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      INFO("ray " << i << ", " << name_of(out));
      const Walk walk = recorder.record(rays[i]);
      CHECK(same_bits(walk.hit, hits[i]));
      CHECK(inconsistency(walk) == "");
      CHECK(walk.hit.instance == target);
      entered = std::max<std::size_t>(entered, walk.passes > 2 ? walk.hit.transforms : 0);
    }
  }
  CHECK(entered > 200);
}

TEST_CASE("rays without an answer, and empty scenes", "[walk]") {
  const GeometryImage image = bake(load_scene("creature"));
  Ray ray;
  ray.direction = {0.0f, 0.0f, 0.0f};
  const Walk undefined = capture_walk(context(), image, ray);
  CHECK(undefined.hit.kind == HitKind::undefined);
  CHECK(undefined.steps.empty());
  const GeometryImage nothing = bake(Scene{});
  ray.direction = {0.0f, 0.0f, 1.0f};
  CHECK(capture_walk(context(), nothing, ray).hit.kind == HitKind::miss);
}

TEST_CASE("nothing of a capture is in the production's text", "[walk]") {
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
      ProgramVariant variant{layout, bounds, true, true, false, true, true, true, false};
      const std::string text = probe_fragment_shader(variant).text;
      std::string kept;  // what the preprocessor keeps
      std::size_t depth = 0, hooks = 0, at = 0;
      while (at < text.size()) {
        const std::size_t end = text.find('\n', at) + 1;
        const std::string line = text.substr(at, end - at);
        at = end;
        if (depth == 0 && line == "#ifdef CAPTURE\n") {
          depth = 1, ++hooks;
        } else if (depth > 0) {
          if (line.starts_with("#if")) ++depth;
          if (line.starts_with("#endif")) --depth;
        } else {
          kept += line;
        }
      }
      CHECK(depth == 0);
      CHECK(hooks > 10);
      CHECK(kept.find("CAPTURE") == std::string::npos);
      CHECK(kept.find("capture_") == std::string::npos);
      CHECK(kept.find("captured") == std::string::npos);
      variant.capture = true;
      CHECK(probe_fragment_shader(variant).text.find("#define CAPTURE") != std::string::npos);
    }
  }
}

TEST_CASE("two walks part where what they walk through was changed, and not before", "[walk]") {
  const Scene scene = load_scene("creature");
  const GeometryImage image = bake(scene);
  WalkRecorder recorder(context(), image);
  std::size_t parted = 0;
  for (const Ray& ray : some_rays(scene, 8, 11)) {
    const Walk sound = recorder.record(ray);
    CHECK_FALSE(first_divergence(sound, recorder.record(ray)));
    if (sound.steps.size() < 8) continue;
    const std::size_t at = sound.steps.size() / 2;
    GeometryImage broken = image;
    broken.texels[sound.steps[at].cell].x += 1e-3f * image.radius;
    WalkRecorder other(context(), broken);
    const auto divergence = first_divergence(sound, other.record(ray));
    REQUIRE(divergence);
    CHECK(divergence->step == at);
    ++parted;
  }
  CHECK(parted > 2);
  // A fault in the primitives' arithmetic: at the first triangle that is hit.
  const std::array<ShaderPatch, 1> patches{
      ShaderPatch{"triangle.glsl", "hit.weights = vec2(v, w) * inverse;", "hit.weights = vec2(w, v) * inverse;"}};
  WalkRecorder patched(context(), image, patches);
  for (const Ray& ray : some_rays(scene, 8, 12)) {
    const Walk sound = recorder.record(ray);
    std::size_t first = 0;
    while (first < sound.steps.size() && sound.steps[first].primitives.empty()) ++first;
    const auto divergence = first_divergence(sound, patched.record(ray));
    REQUIRE(divergence.has_value() == (first < sound.steps.size()));
    if (divergence) CHECK(divergence->step == first);
  }
}
