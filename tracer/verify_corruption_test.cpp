// SPDX-License-Identifier: MIT
// Random corruption: single texels that change at random are caught by the certificate or by rays, or no ray can be
// answered differently; nothing hangs, nothing crashes.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "scenes/random.h"
#include "scenes/rays.h"
#include "tracer/broken_trees.h"
#include "tracer/image_view.h"
#include "tracer/probe.h"
#include "tracer/verify.h"

namespace plumbline {
namespace {

GlContext& context() {
  static GlContext shared;
  return shared;
}

/// Changes of single texels that are tried; the environment may ask for more.
std::size_t trial_count() {
  const char* asked = std::getenv("PLUMBLINE_CORRUPTIONS");
  return asked != nullptr ? static_cast<std::size_t>(std::strtoul(asked, nullptr, 10)) : 1000;
}

std::vector<Ray> fixed_rays(const Scene& scene, std::size_t of_each) {
  const RaySource source(scene);
  std::vector<Ray> rays;
  for (const RayFamily family : {RayFamily::camera, RayFamily::chords, RayFamily::aimed_vertices,
                                 RayFamily::aimed_edges, RayFamily::tangents, RayFamily::inside, RayFamily::far}) {
    std::vector<Ray> some(of_each);
    generate_rays(source, family, 3, 0, some);
    rays.insert(rays.end(), some.begin(), some.end());
  }
  return rays;
}

bool same_answers(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    Hit p = a[i], q = b[i];
    p.steps = q.steps = p.primitive_tests = q.primitive_tests = p.transforms = q.transforms = 0;
    if (std::memcmp(&p, &q, sizeof(Hit)) != 0) return false;
  }
  return true;
}

/// Another value for a component: a bit flipped, all bits drawn, a neighbour's value, or a few units in the last place.
float corrupted(float value, const GeometryImage& image, Random& random) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  switch (random.below(4)) {
    case 0:
      return std::bit_cast<float>(bits ^ 1u << random.below(32));
    case 1:
      return std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
    case 2:
      return image
          .texels[random.below(static_cast<std::uint32_t>(image.texels.size()))][static_cast<int>(random.below(4))];
    default:
      return std::bit_cast<float>(bits + 1 + random.below(8));
  }
}

/// What a change is harmless by: it stands in bounds, which the certificate has found to hold everything still.
bool is_in_bounds(const GeometryImage& image, std::size_t texel, int component) {
  const std::size_t width = static_cast<std::size_t>(image.width);
  const bool compact = is_compact(image);
  const std::uint64_t unit = compact ? texel : texel / width / 2 * width + texel % width;
  const bool is_upper_row = compact || texel / width % 2 == 0;
  return unit < image.primitive_start && is_upper_row && (component < 3 || !has_boxes(image));
}

struct Tally {
  std::size_t by_image = 0;  ///< found by the certificate of the image alone
  std::size_t by_scene = 0;  ///< found by the one that has scene and tree, not by that of the image alone
  std::size_t by_both = 0;   ///< of these, how many the rays see too
  std::size_t by_rays = 0;   ///< found by rays alone
  std::size_t harmless = 0, unexplained = 0;
};

void corrupt(const char* scene_name, const BakeOptions& options, std::size_t trials, Tally& tally) {
  const BrokenTree tree = sound_tree(scene_name, options);
  const std::vector<Ray> rays = fixed_rays(tree.scene, 60);
  Probe probe(context(), tree.sound);
  std::vector<Hit> truth(rays.size()), hits(rays.size());
  probe.trace(rays, truth);
  GeometryImage image = tree.sound;
  std::size_t used = 0;  // texels up to the last that holds anything, and a few behind
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    if (!is_zero_bits(image.texels[i])) used = i + 1;
  used = std::min(used + used / 32 + 1, image.texels.size());
  for (std::size_t trial = 0; trial < trials; ++trial) {
    Random random(11,
                  name_hash(scene_name) + static_cast<std::uint64_t>(options.layout) * 8 +
                      static_cast<std::uint64_t>(options.bounds) * 4 + static_cast<std::uint64_t>(options.links),
                  trial);
    std::size_t texel = 0;
    int component = 0;
    float before = 0.0f, after = 0.0f;
    do {
      texel = random.below(static_cast<std::uint32_t>(used)), component = static_cast<int>(random.below(4));
      before = image.texels[texel][component], after = corrupted(before, image, random);
    } while (std::bit_cast<std::uint32_t>(before) == std::bit_cast<std::uint32_t>(after));
    image.texels[texel][component] = after;
    const bool is_found_alone = !certify(image).is_sound();
    const bool is_found = is_found_alone || !certify(image, &tree.scene, &tree.tree).is_sound();
    // What is found already is traced now and then, to see that nothing hangs.
    if (!is_found_alone || trial % 16 == 0) {
      probe.set_image(image);
      probe.trace(rays, hits);
    }
    const bool is_seen = !is_found_alone && !same_answers(hits, truth);
    const bool is_bound = is_in_bounds(image, texel, component);
    if (is_found_alone)
      ++tally.by_image;
    else if (is_found)
      ++tally.by_scene, tally.by_both += is_seen;
    else
      ++(is_seen ? tally.by_rays : is_bound ? tally.harmless : tally.unexplained);
    if (!is_found && (is_seen || !is_bound))
      UNSCOPED_INFO("trial " << trial << ": texel " << texel << ", component " << component << " from " << before
                             << " to " << after);
    image.texels[texel][component] = before;
  }
}

}  // namespace

TEST_CASE("a texel that changes at random is found, or no ray can tell", "[verify]") {
  std::vector<std::pair<const char*, BakeOptions>> kinds;
  for (const char* scene : {"triangles", "spheres", "split", "nested"})
    for (const Layout layout : {Layout::compact, Layout::paper})
      for (const Bounds bounds : {Bounds::sphere, Bounds::aabb})
        for (const Links links : {Links::threaded, Links::octant}) {
          BakeOptions options;
          options.layout = layout, options.bounds = bounds, options.links = links, options.width = 16;
          options.tree.split_long = std::string_view(scene) == "split" ? 0.3f : 0.0f;
          kinds.emplace_back(scene, options);
        }
  Tally tally;
  for (const auto& [scene, options] : kinds) {
    UNSCOPED_INFO(scene << " " << name_of(options.layout) << " " << name_of(options.bounds) << " "
                        << name_of(options.links));
    corrupt(scene, options, std::max<std::size_t>(trial_count() / kinds.size(), 1), tally);
  }
  WARN(tally.by_image << " found in the image alone, " << tally.by_scene << " with scene and tree (" << tally.by_both
                      << " of them seen by rays too), " << tally.by_rays << " by rays alone, " << tally.harmless
                      << " in bounds that hold everything still");
  // What the certificate passes, no ray may tell: that is what it certifies.
  CHECK(tally.by_rays == 0);
  CHECK(tally.unexplained == 0);
  CHECK(tally.by_image > 10 * tally.harmless);
  CHECK(tally.by_scene > 0);
  CHECK(tally.harmless > 0);
}

TEST_CASE("records that lead in circles, nowhere or too deep end a walk all the same", "[verify]") {
  using Change = void (*)(GeometryImage&, std::uint32_t);
  const auto set = [](GeometryImage& image, std::uint32_t n, std::uint32_t texel, int component, float value) {
    image.texels[transform_texel(image, n, texel)][component] = value;
  };
  static const auto change = set;
  const std::pair<const char*, Change> changes[] = {
      {"deeper than loops go", [](GeometryImage& i, std::uint32_t n) { change(i, n, 7, 2, 70000.0f); }},
      {"its own parent", [](GeometryImage& i, std::uint32_t n) { change(i, n, 3, 3, static_cast<float>(n + 1)); }},
      {"parent NaN", [](GeometryImage& i, std::uint32_t n) { change(i, n, 3, 3, std::nanf("")); }},
      {"into the world", [](GeometryImage& i, std::uint32_t n) { change(i, n, 4, 3, 0.0f); }},
      {"into nothing", [](GeometryImage& i, std::uint32_t n) { change(i, n, 4, 3, -1e9f); }},
      {"out to the root", [](GeometryImage& i, std::uint32_t n) {
         for (int c = 0; c < 8; ++c) change(i, n, 8 + static_cast<std::uint32_t>(c) / 4, c % 4, 0.0f);
       }}};
  for (const Layout layout : {Layout::compact, Layout::paper})
    for (const auto& [name, make] : changes) {
      BakeOptions options;
      options.layout = layout, options.width = 16;
      const BrokenTree tree = sound_tree("nested", options);
      GeometryImage image = tree.sound;
      for (std::uint32_t n = 0; n < image.transform_count; ++n) make(image, n);
      INFO(name_of(layout) << ": " << name);
      CHECK_FALSE(certify(image).is_sound());
      const std::vector<Ray> rays = fixed_rays(tree.scene, 20);
      std::vector<Hit> hits(rays.size());
      Probe probe(context(), image);
      probe.trace(rays, hits);  // comes back
      for (const Hit& hit : hits) CHECK(hit.kind != HitKind::undefined);
    }
}

TEST_CASE("attributes that change at random are found, and nothing crashes", "[verify]") {
  BakeOptions options;
  options.width = 16;
  for (const Layout layout : {Layout::compact, Layout::paper}) {
    options.layout = layout;
    const BrokenTree tree = sound_tree("nested", options);
    std::size_t missed = 0;
    for (std::size_t trial = 0; trial < 200; ++trial) {
      Random random(12, static_cast<std::uint64_t>(layout), trial);
      GeometryImage image = tree.sound;
      std::uint32_t* counts[] = {&image.cell_count,       &image.triangle_count,  &image.sphere_count,
                                 &image.primitive_count,  &image.primitive_start, &image.primitive_stride,
                                 &image.world_primitives, &image.transform_start, &image.transform_count,
                                 &image.copy_count,       &image.copy_size};
      std::uint32_t& count = *counts[random.below(std::size(counts))];
      const std::uint32_t change =
          random.below(3) == 0 ? static_cast<std::uint32_t>(random.bits()) : 1u << random.below(32);
      if (change == 0) continue;
      count ^= change;
      missed += certify(image, &tree.scene, &tree.tree).is_sound();
    }
    CHECK(missed == 0);
    GeometryImage image = tree.sound;
    image.texels.resize(image.texels.size() / 2);
    CHECK_FALSE(certify(image).is_sound());
    image = tree.sound;
    image.width *= 2;
    CHECK_FALSE(certify(image).is_sound());
    image = tree.sound;
    image.payload_bits = layout == Layout::compact ? image.payload_bits - 1 : 24;
    CHECK_FALSE(certify(image).is_sound());
    image = tree.sound;
    for (glm::vec4& texel : image.texels) texel = glm::vec4(1.0f);
    CHECK_FALSE(certify(image, &tree.scene, &tree.tree).is_sound());
    Random random(13, 0, 0);
    for (int trial = 0; trial < 20; ++trial) {
      for (glm::vec4& texel : image.texels)
        for (int i = 0; i < 4; ++i) texel[i] = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
      CHECK_FALSE(certify(image, &tree.scene, &tree.tree).is_sound());
    }
  }
}

}  // namespace plumbline
