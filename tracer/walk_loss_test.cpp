// SPDX-License-Identifier: MIT
// What a broken image lost is found with the node, the link or the transform that lost it.
#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/random.h"
#include "tracer/image_structure.h"
#include "tracer/image_view.h"
#include "tracer/walk_analysis.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

GlContext& context() {
  static GlContext instance;
  return instance;
}

/// Walks of random rays that hit something.
std::vector<Walk> hitting_walks(const Scene& scene, WalkRecorder& recorder, std::size_t rays) {
  const Ball ball = bounding_ball(scene);
  std::vector<Walk> walks;
  for (std::size_t i = 0; i < rays; ++i) {
    Random random(7, 1, i);
    Ray ray;
    ray.origin = glm::vec3(ball.center + random.direction() * (ball.radius * 1.5));
    const glm::dvec3 at = ball.center + random.direction() * (ball.radius * 0.5 * random.uniform());
    ray.direction = glm::vec3(at - glm::dvec3(ray.origin));
    Walk walk = recorder.record(ray);
    if (walk.hit.kind == HitKind::hit) walks.push_back(std::move(walk));
  }
  return walks;
}

ExpectedHit expected_of(const Walk& walk) {
  return {walk.hit.instance, walk.hit.primitive, static_cast<double>(walk.hit.t)};
}

Walk walk_through(WalkRecorder& recorder, const GeometryImage& image, const Ray& ray) {
  recorder.set_image(image);
  return recorder.record(ray, 20'000);
}

bool same_hit(const Walk& a, const Walk& b) {
  return a.hit.kind == b.hit.kind && a.hit.primitive == b.hit.primitive && a.hit.instance == b.hit.instance;
}

BakeOptions options_of(Layout layout, Bounds bounds, TransformOut out = TransformOut::restore) {
  BakeOptions options;
  options.layout = layout, options.bounds = bounds, options.transform_out = out;
  return options;
}

std::array<const GeometryImage*, 2> with_and_without(const GeometryImage& sound) { return {&sound, nullptr}; }

glm::vec4& texel(GeometryImage& image, std::uint32_t cell, int row = 0) {
  return image.texels[unit_texel(image, cell, row)];
}

/// Makes a node's sphere smaller than this squared distance, its box a point.
void shrink(GeometryImage& image, std::uint32_t cell, float distance2) {
  if (has_boxes(image)) {
    const float w = texel(image, cell + 1).w;
    texel(image, cell + 1) = glm::vec4(glm::vec3(texel(image, cell)), w);
    return;
  }
  float& w = texel(image, cell).w;
  if (!is_compact(image)) {
    w = 0.98f * distance2;
    return;
  }
  const std::uint32_t mask = (1u << image.payload_bits) - 1u,
                      kept = std::bit_cast<std::uint32_t>(w) & (mask | 1u << 31);
  w = std::bit_cast<float>((std::bit_cast<std::uint32_t>(0.9f * distance2) & ~mask) | kept);
}

/// Exchanges where two inner nodes lead where they are missed.
void swap_links(GeometryImage& image, std::uint32_t a, std::uint32_t b) {
  if (!is_compact(image)) {
    std::swap(texel(image, a, 1).z, texel(image, b, 1).z);
    std::swap(texel(image, a, 1).w, texel(image, b, 1).w);
    return;
  }
  const std::uint32_t mask = (1u << image.payload_bits) - 1u;
  const auto bits = [&](std::uint32_t cell) { return std::bit_cast<std::uint32_t>(texel(image, cell).w); };
  const std::uint32_t x = bits(a), y = bits(b);
  texel(image, a).w = std::bit_cast<float>((x & ~mask) | (y & mask));
  texel(image, b).w = std::bit_cast<float>((y & ~mask) | (x & mask));
}

/// The first transform that a walk leaves, and the index of the step; the hit comes later and elsewhere.
std::uint32_t left_before_hit(const Walk& walk, const GeometryImage& image, std::size_t& at) {
  const auto path = transforms_to(image, walk.hit.instance);
  for (std::size_t i = 0; i < walk.steps.size(); ++i) {
    for (const TestedPrimitive& tested : walk.steps[i].primitives)
      if (tested.outcome == PrimitiveTest::new_nearest && tested.primitive == walk.hit.primitive) return kNone;
    for (std::size_t k = 0; k < walk.steps[i].changes.size(); ++k) {
      const SpaceChange& change = walk.steps[i].changes[k];
      const bool has_missed = k > 0 && walk.steps[i].changes[k - 1].kind == SpaceChange::Kind::missed;
      if (change.kind == SpaceChange::Kind::left && !has_missed &&
          std::find(path->begin(), path->end(), change.node) == path->end()) {
        at = i;
        return change.node;
      }
    }
  }
  return kNone;
}

}  // namespace

TEST_CASE("a volume that was shrunk is named, with what it lacks", "[walk]") {
  std::size_t found = 0, behind_transforms = 0;
  for (const char* name : {"creature", "nested"}) {
    const Scene scene = load_scene(name);
    for (const Bounds bounds : {Bounds::sphere, Bounds::aabb}) {
      for (const Layout layout :
           {scene.nodes.empty() == (bounds == Bounds::sphere) ? Layout::compact : Layout::paper}) {
        const GeometryImage image = bake(scene, options_of(layout, bounds));
        WalkRecorder recorder(context(), image);
        std::uint32_t turn = 0;
        for (const Walk& walk : hitting_walks(scene, recorder, 16)) {
          const ExpectedHit expected = expected_of(walk);
          const Loss none = lost_at(image, walk, expected);
          CHECK(none.kind == LossKind::none);
          REQUIRE_FALSE(none.chain.empty());
          const Ancestor& victim =
              none.chain[Random(9, 1, turn++).below(static_cast<std::uint32_t>(none.chain.size()))];
          REQUIRE(victim.step != kNoStep);
          const float distance2 = walk.steps[victim.step].distance2;
          if (bounds == Bounds::sphere && !(distance2 > 0.0f)) continue;
          GeometryImage broken = image;
          shrink(broken, victim.cell, distance2);
          const Walk lost = walk_through(recorder, broken, walk.ray);
          INFO(name << ", " << name_of(layout) << ", " << name_of(bounds) << ", cell " << victim.cell << " behind "
                    << victim.space);
          REQUIRE_FALSE(same_hit(lost, walk));
          for (const GeometryImage* sound : with_and_without(image)) {
            const Loss loss = lost_at(broken, lost, expected, sound);
            INFO(loss.sentence);
            CHECK(loss.kind == LossKind::bounds);
            CHECK(loss.cell == victim.cell);
            CHECK(loss.space == victim.space);
            CHECK(loss.shortfall > 0.0);
            if (bounds == Bounds::sphere) {
              CHECK(loss.distance == std::sqrt(static_cast<double>(distance2)));
              CHECK(loss.radius < loss.distance);
            }
            CHECK(loss.as_baked.has_value() == (sound != nullptr));
            CHECK_FALSE(loss.as_baked.value_or(false));
            CHECK_THAT(loss.sentence,
                       Contains("cell (" + std::to_string(victim.x) + ", " + std::to_string(victim.y) + ") ") &&
                           Contains("primitive " + std::to_string(walk.hit.primitive)));
          }
          ++found;
          behind_transforms += victim.space != kNone;
        }
      }
    }
  }
  CHECK(found > 15);
  CHECK(behind_transforms > 4);
}

TEST_CASE("of two links that were swapped the one that led past is named", "[walk]") {
  const Scene scene = load_scene("creature");
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    const GeometryImage image = bake(scene, options_of(layout, Bounds::sphere));
    WalkRecorder recorder(context(), image);
    std::size_t found = 0;
    for (const Walk& walk : hitting_walks(scene, recorder, 24)) {
      const ExpectedHit expected = expected_of(walk);
      std::vector<std::uint32_t> missed, inner;
      for (const WalkStep& step : walk.steps) {
        const NodeCell node = node_cell(image, step.cell);
        if (node.is_leaf || node.is_end) continue;
        inner.push_back(step.cell);
        if (step.test != NodeTest::hit) missed.push_back(step.cell);
      }
      if (missed.empty()) continue;
      for (std::uint32_t turn = 0; turn < 6; ++turn) {
        Random random(4, turn, missed.front());
        const std::uint32_t a = missed[random.below(static_cast<std::uint32_t>(missed.size()))];
        const std::uint32_t b = inner[random.below(static_cast<std::uint32_t>(inner.size()))];
        GeometryImage broken = image;
        swap_links(broken, a, b);
        const Walk lost = walk_through(recorder, broken, walk.ray);
        if (same_hit(lost, walk)) continue;
        const Loss loss = lost_at(broken, lost, expected, &image);
        INFO(name_of(layout) << ", cells " << a << ", " << b << ": " << loss.sentence);
        CHECK(loss.kind == LossKind::link);
        CHECK((loss.cell == a || loss.cell == b));
        CHECK(loss.expected_cell == node_cell(image, loss.cell).out);
        CHECK(loss.reached_cell == node_cell(broken, loss.cell).out);
        CHECK(loss.as_baked == false);
        CHECK_THAT(loss.sentence, Contains("a link of node"));
        // Without the sound image the cell is the same, though a volume may seem to be the reason.
        const Loss alone = lost_at(broken, lost, expected);
        INFO(alone.sentence);
        CHECK((alone.kind == LossKind::link || alone.kind == LossKind::bounds));
        CHECK((alone.cell == a || alone.cell == b));
        ++found;
      }
    }
    CHECK(found > 4);
  }
}

TEST_CASE("a transform whose way out is removed or leads elsewhere is named", "[walk]") {
  const Scene scene = load_scene("nested");
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    for (const TransformOut out : {layout == Layout::compact ? TransformOut::restore : TransformOut::inverse}) {
      const GeometryImage image = bake(scene, options_of(layout, Bounds::sphere, out));
      WalkRecorder recorder(context(), image);
      std::size_t removed = 0, misled = 0;
      for (const Walk& walk : hitting_walks(scene, recorder, 30)) {
        std::size_t at = 0;
        const std::uint32_t node = left_before_hit(walk, image, at);
        if (node == kNone) continue;
        const ExpectedHit expected = expected_of(walk);
        // The end of the region behind it.
        std::size_t in = 0;
        const auto entered = [&](const SpaceChange& c) {
          return c.kind == SpaceChange::Kind::entered && c.node == node;
        };
        while (std::none_of(walk.steps[in].changes.begin(), walk.steps[in].changes.end(), entered)) ++in;
        const std::uint32_t walked =
            std::find_if(walk.steps[in].changes.begin(), walk.steps[in].changes.end(), entered)->copy;
        const auto copy = region_copy(image, node, walked);
        REQUIRE(copy);
        GeometryImage broken = image;
        if (layout == Layout::compact) {
          texel(broken, copy->end - 1) = glm::vec4(0.0f);
        } else {
          for (std::uint32_t cell = copy->begin; cell < copy->end; ++cell) {
            glm::vec4& links = texel(broken, cell, 1);
            if (links.z < static_cast<float>(kLinkTransform)) links.z -= static_cast<float>(kLinkEnd);
          }
        }
        Walk lost = walk_through(recorder, broken, walk.ray);
        if (!same_hit(lost, walk)) {
          for (const GeometryImage* sound : with_and_without(image)) {
            const Loss loss = lost_at(broken, lost, expected, sound);
            INFO(name_of(layout) << ", removed, node " << node << ": " << loss.sentence);
            CHECK(loss.kind == LossKind::way_out);
            CHECK(loss.transform == node);
            CHECK(loss.space == node);
          }
          ++removed;
        }
        // The record's leaf address: to the last node of the space around it.
        broken = image;
        const std::uint32_t outer = walk.steps[in].space;
        std::uint32_t last = 0;
        for (const WalkStep& step : walk.steps)
          if (step.space == outer && !node_cell(image, step.cell).is_end) last = std::max(last, step.cell);
        const auto octant = walk.steps[in].copy;
        broken.texels[transform_texel(broken, node, 8 + octant / 4)][static_cast<int>(octant % 4)] =
            static_cast<float>(last);
        lost = walk_through(recorder, broken, walk.ray);
        if (!same_hit(lost, walk)) {
          for (const GeometryImage* sound : with_and_without(image)) {
            const Loss loss = lost_at(broken, lost, expected, sound);
            INFO(name_of(layout) << ", misled, node " << node << ": " << loss.sentence);
            CHECK(loss.kind == LossKind::way_out);
            CHECK(loss.transform == node);
            CHECK(loss.space == outer);
            CHECK_FALSE(loss.as_baked.value_or(false));
          }
          ++misled;
        }
      }
      CHECK(removed > 1);
      CHECK(misled > 1);
    }
  }
}

TEST_CASE("a transform whose way in is wrong is named", "[walk]") {
  const Scene scene = load_scene("nested");
  const GeometryImage image = bake(scene);
  WalkRecorder recorder(context(), image);
  std::size_t found[3] = {};
  for (const Walk& walk : hitting_walks(scene, recorder, 20)) {
    if (walk.hit.instance == kNone) continue;
    const ExpectedHit expected = expected_of(walk);
    const auto path = transforms_to(image, walk.hit.instance);
    for (const std::uint32_t fault : {0u, 1u, 2u}) {
      const std::uint32_t node = path->at(fault % path->size());
      GeometryImage broken = image;
      const auto record = [&](std::uint32_t i) -> glm::vec4& {
        return broken.texels[transform_texel(broken, node, i)];
      };
      if (fault == 0) record(0).w += 3.0f * image.radius;              // the translation
      if (fault == 1) record(6) = glm::vec4(1e5f, 0.0f, 0.0f, 1e-3f);  // the ball
      if (fault == 2) record(4).w = 0.0f;                              // where the region starts
      const Walk lost = walk_through(recorder, broken, walk.ray);
      if (same_hit(lost, walk)) continue;
      const Loss loss = lost_at(broken, lost, expected, &image);
      INFO("fault " << fault << ": " << loss.sentence);
      CHECK(loss.kind == LossKind::way_in);
      CHECK(loss.transform == node);
      CHECK(loss.as_baked == false);
      ++found[fault];
    }
  }
  for (const std::size_t n : found) CHECK(n > 3);
}

TEST_CASE("leaves and primitives that lose a ray are told apart from volumes", "[walk]") {
  const Scene scene = load_scene("creature");
  const GeometryImage image = bake(scene);
  WalkRecorder recorder(context(), image);
  std::size_t cut = 0, moved = 0;
  for (const Walk& walk : hitting_walks(scene, recorder, 24)) {
    const ExpectedHit expected = expected_of(walk);
    const TestedPrimitive* hit = nullptr;
    const WalkStep* leaf = nullptr;
    for (const WalkStep& step : walk.steps)
      for (const TestedPrimitive& tested : step.primitives)
        if (tested.primitive == expected.primitive && tested.outcome == PrimitiveTest::new_nearest)
          hit = &tested, leaf = &step;
    REQUIRE(hit != nullptr);
    GeometryImage broken = image;
    const auto texels = primitive_texels(image, hit->k);
    for (const std::size_t at : texels) broken.texels[at].y += 4.0f * image.radius;
    Walk lost = walk_through(recorder, broken, walk.ray);
    Loss loss = lost_at(broken, lost, expected, &image);
    INFO(loss.sentence);
    CHECK(loss.kind == LossKind::primitive);
    CHECK(loss.cell == leaf->cell);
    REQUIRE(loss.test);
    CHECK(loss.test->outcome == PrimitiveTest::outside);
    CHECK(loss.as_baked == false);
    ++moved;
    if (hit == &leaf->primitives.front()) continue;
    broken = image;
    broken.texels[primitive_texels(image, hit->k - 1)[0]].w *= -1.0f;  // its cluster ends before it
    lost = walk_through(recorder, broken, walk.ray);
    loss = lost_at(broken, lost, expected, &image);
    CHECK(loss.kind == LossKind::leaf);
    CHECK(loss.cell == leaf->cell);
    ++cut;
  }
  CHECK(moved > 8);
  CHECK(cut > 2);
}

TEST_CASE("a sound image that loses a ray is not blamed", "[walk]") {
  const Scene scene = load_scene("creature");
  const GeometryImage image = bake(scene);
  WalkRecorder recorder(context(), image);
  const auto patched = [&](ShaderPatch patch) {
    const std::array<ShaderPatch, 1> patches{std::move(patch)};
    return WalkRecorder(context(), image, patches);
  };
  WalkRecorder small = patched({"bounds.glsl", "return dot(f, f);", "return 40.0 * dot(f, f);"});
  WalkRecorder no_triangle =
      patched({"triangle.glsl", "hit.inside = min(min(u, v), w) >= 0.0 || max(max(u, v), w) <= 0.0;",
               "hit.inside = min(min(u, v), w) >= 0.0;"});
  std::size_t bounds = 0, primitives = 0;
  for (const Walk& walk : hitting_walks(scene, recorder, 24)) {
    const ExpectedHit expected = expected_of(walk);
    if (const Walk lost = small.record(walk.ray); !same_hit(lost, walk)) {
      const Loss loss = lost_at(image, lost, expected, &image);
      CHECK(loss.kind == LossKind::bounds);
      CHECK(loss.as_baked == true);
      CHECK_THAT(loss.sentence, Contains("the image is as baked there") && Contains("rejected the ray by ") &&
                                    Contains("units of its space") && !Contains("too small"));
      CHECK(loss.world_shortfall == loss.shortfall);  // the world's own space, whose units are the image's
      ++bounds;
    }
    if (const Walk lost = no_triangle.record(walk.ray); !same_hit(lost, walk)) {
      const Loss loss = lost_at(image, lost, expected, &image);
      CHECK(loss.kind == LossKind::primitive);
      CHECK(loss.as_baked == true);
      ++primitives;
    }
    // What was never lost: the same, and something behind it.
    CHECK(lost_at(image, walk, expected).kind == LossKind::none);
    for (const WalkStep& step : walk.steps)
      for (const TestedPrimitive& tested : step.primitives)
        if (tested.outcome == PrimitiveTest::farther)
          CHECK(lost_at(image, walk, {kNone, tested.primitive}).kind == LossKind::nearer);
    CHECK(lost_at(image, walk, {kNone, scene.primitive_count()}).kind == LossKind::absent);
    CHECK(lost_at(image, walk, {0, 0}).kind == LossKind::absent);
  }
  CHECK(bounds > 2);
  CHECK(primitives > 2);
  const GeometryImage other = bake(load_scene("nested"));
  CHECK_THROWS_AS(lost_at(image, Walk{}, {}, &other), InputError);
}

TEST_CASE("a walk in a circle is led back to the link that closes it", "[walk]") {
  const Scene scene = load_scene("creature");
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    const GeometryImage image = bake(scene, options_of(layout, Bounds::sphere));
    WalkRecorder recorder(context(), image);
    std::size_t found = 0;
    for (const Walk& walk : hitting_walks(scene, recorder, 12)) {
      std::size_t at = 0;
      while (at < walk.steps.size() &&
             (walk.steps[at].test == NodeTest::hit || node_cell(image, walk.steps[at].cell).is_leaf))
        ++at;
      bool is_before = false;
      for (std::size_t i = at; i < walk.steps.size(); ++i)
        for (const TestedPrimitive& tested : walk.steps[i].primitives)
          is_before = is_before || tested.primitive == walk.hit.primitive;
      if (!is_before) continue;
      const std::uint32_t cell = walk.steps[at].cell;
      GeometryImage broken = image;
      if (layout == Layout::compact) {
        const std::uint32_t mask = (1u << image.payload_bits) - 1u;
        float& w = texel(broken, cell).w;
        w = std::bit_cast<float>(std::bit_cast<std::uint32_t>(w) & ~mask);
      } else {
        glm::vec4& links = texel(broken, cell, 1);
        links.z = (static_cast<float>(cell % static_cast<std::uint32_t>(image.width)) + 0.5f) /
                  static_cast<float>(image.width);
        links.w = (static_cast<float>(cell / static_cast<std::uint32_t>(image.width) * 2) + 0.5f) /
                  static_cast<float>(image.height);
      }
      const Walk lost = walk_through(recorder, broken, walk.ray);
      if (lost.hit.kind != HitKind::capped) continue;
      for (const GeometryImage* sound : with_and_without(image)) {
        const Loss loss = lost_at(broken, lost, expected_of(walk), sound);
        INFO(name_of(layout) << ": " << loss.sentence);
        CHECK(loss.kind == LossKind::link);
        CHECK(loss.cell == cell);
      }
      ++found;
    }
    CHECK(found > 2);
  }
}
