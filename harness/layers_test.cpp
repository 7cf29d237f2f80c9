// SPDX-License-Identifier: GPL-3.0-or-later
// Layers are told apart also where instances stand: what is stored, the arithmetic, and the transforms.
#include "harness/layers.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "harness/explain.h"
#include "harness/explained_cases.h"
#include "harness/scene_list.h"
#include "scenes/generate.h"
#include "tracer/image_view.h"

using namespace plumbline;
using Catch::Matchers::Contains;

namespace {

/// Four spheres in one part, that stands in the world twice as large and aside.
Scene four_spheres() {
  Scene scene;
  scene.name = "four_spheres";
  scene.materials.resize(1);
  for (int i = 0; i < 4; ++i) scene.spheres.push_back({{static_cast<float>(i), 0.0f, 0.0f}, 1.0f, 0});
  scene.parts.push_back({"row", 0, 0, 0, 4});
  Node node;
  node.name = "row";
  node.part = 0;
  node.transform.linear = glm::mat3(2.0f);
  node.transform.translation = {1.0f, 2.0f, 3.0f};
  node.rest = node.transform;
  scene.nodes.push_back(node);
  return scene;
}

/// The first explanations of rays that fail in instances, at most `most`.
std::vector<Explanation> failing(Session& session, const Stage& stage, const GeometryImage& image,
                                 std::span<const ShaderPatch> patches, std::size_t most) {
  const Judge judge_data = stage.judge_of(image.options.transform_out);
  Probe probe(session.context(), image, Traversal::tree, patches);
  Examiner examiner(session, {&stage, &image, &stage.image_of(image.options.transform_out), patches, "broken"});
  std::vector<Explanation> found;
  std::vector<Ray> rays(2048);
  generate_rays(stage.rays, RayFamily::inside, 5, 0, rays);
  std::vector<Hit> hits(rays.size());
  std::vector<ReferenceHit> truths(rays.size());
  probe.trace(rays, hits);
  stage.embree.intersect(rays, truths);
  for (std::size_t i = 0; i < rays.size() && found.size() < most; ++i) {
    if (hits[i].kind != HitKind::hit || (!stage.scene.nodes.empty() && hits[i].instance == kNone)) continue;
    if (is_failure(judge(judge_data, rays[i], hits[i], truths[i]).verdict)) found.push_back(examiner.explain(rays[i]));
  }
  return found;
}

}  // namespace

TEST_CASE("A primitive that stands elsewhere in the image is the tree's fault, not a transform's") {
  Session session;
  const Stage& stage = session.stage("four spheres", four_spheres());
  GeometryImage broken = stage.image;
  // They share a leaf whose ball reaches far above them: what moves up a little still stands in it.
  broken.texels[primitive_texels(broken, 1)[0]].y += 0.5f * stored_primitive(broken, 1).radius;
  std::size_t misses = 0;
  for (const Explanation& e : failing(session, stage, broken, {}, 300)) {
    INFO(e.sentence);
    CHECK(e.layer == Layer::tree);
    if (e.expected.primitive != kNone) continue;
    ++misses;
    CHECK_THAT(e.sentence, !Contains("transform"));
  }
  CHECK(misses > 0);
}

TEST_CASE("Faults of arithmetic are not blamed on transforms where instances stand") {
  Session session;
  const Stage& stage = session.stage("nested");
  const ShaderPatch patches[] = {
      {"triangle.glsl", "hit.t = (((u * a.z + v * b.z) + w * c.z) * inverse) * ray.shear.z;",
       "hit.t = (((u * a.z + v * b.z) + w * c.z) * inverse) * ray.shear.z * 1.001;"},
      {"triangle.glsl", "hit.weights = vec2(v, w) * inverse;", "hit.weights = vec2(w, v) * inverse;"},
      {"triangle.glsl", "return n * (1.0 / sqrt(dot(n, n)));", "return n * (-1.0 / sqrt(dot(n, n)));"},
      {"sphere.glsl", "enter > ray.t_low ? enter", "enter <= ray.t_low ? enter"}};
  for (const ShaderPatch& patch : patches) {
    INFO(patch.replace);
    const auto found = failing(session, stage, stage.image, {&patch, 1}, 4);
    CHECK_FALSE(found.empty());
    for (const Explanation& e : found) {
      INFO(e.sentence);
      CHECK(e.layer == Layer::primitive_arithmetic);
    }
  }
}

TEST_CASE("Wrong values of the right primitive need no loop over all primitives to be told") {
  Session session;
  const ShaderPatch turned{"triangle.glsl", "return n * (1.0 / sqrt(dot(n, n)));",
                           "return n * (-1.0 / sqrt(dot(n, n)));"};
  const ShaderPatch by_the_matrix{"result.glsl", "normal = times_transposed(back_0, back_1, back_2, normal);",
                                  "normal = times(row_0, row_1, row_2, normal);"};
  const auto check = [&](const char* spec, const ShaderPatch& patch, Layer layer) {
    const Stage& stage = session.stage(spec);
    std::size_t found = 0;
    for (const Explanation& e : failing(session, stage, stage.image, {&patch, 1}, 4)) {
      if (!e.loss || e.loss->kind != LossKind::none) continue;
      ++found;
      CHECK(layer_of({&stage.image, &stage.image, &e.walk, &*e.loss, e.tracer, false, e.expected}) == layer);
    }
    CHECK(found > 0);
  };
  check("creature", turned, Layer::primitive_arithmetic);
  check("nested", turned, Layer::primitive_arithmetic);
  check("shear", by_the_matrix, Layer::transform);
}

TEST_CASE("No ray of a sound walk is led astray") {
  Session session;
  std::size_t entered = 0;
  for (const ListedScene& listed : placed_scenes()) {
    INFO(listed.spec);
    const Stage& stage = session.stage(listed.spec);
    for (const TransformOut out : {TransformOut::restore, TransformOut::inverse}) {
      WalkRecorder recorder(session.context(), stage.image_of(out));
      for (const RayFamily family : {RayFamily::inside, RayFamily::chords}) {
        std::vector<Ray> rays(12);
        generate_rays(stage.rays, family, 7, 0, rays);
        for (const Ray& ray : rays) {
          const Walk walk = recorder.record(ray, 4000);
          if (walk.skipped > 0) continue;
          entered += walk.hit.transforms;
          CHECK(ray_led_astray(stage.image_of(out), walk) == kNone);
        }
      }
    }
  }
  CHECK(entered > 100);
}
