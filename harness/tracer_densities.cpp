// SPDX-License-Identifier: GPL-3.0-or-later
// Perturbations as the tracer's shaders used them: a picture in which every ray hits a glossy wall beside a ball of
// light, tapped.
#include <algorithm>
#include <string>

#include "harness/densities.h"
#include "scenes/error.h"
#include "tracer/random_numbers.h"

namespace plumbline {
namespace {

/// A square that fills the view of a camera with a lens; a light before it.
Scene wall() {
  Scene scene;
  scene.name = "wall";
  Material material;
  material.specular = 0.5f, material.glossy = 0.5f;
  scene.materials.push_back(material);
  scene.positions = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  for (const std::array<std::uint32_t, 3> corners : {std::array{0u, 1u, 2u}, std::array{0u, 2u, 3u}}) {
    Triangle triangle;
    triangle.position = corners;
    scene.triangles.push_back(triangle);
  }
  scene.lights.push_back({{0, 0, 4}, {1, 1, 1}, true, 0.5f});
  scene.camera.from = {0, 0, 3}, scene.camera.at = {0, 0, 0};
  scene.camera.aperture = 0.25f;
  scene.has_camera = true;
  return scene;
}

/// Keeps what one kind of tap tells of the primary ray, from one dimension on.
class Collector final : public RenderTap {
 public:
  Collector(PerturbationGrid& grid, std::uint32_t first, bool of_places, std::uint32_t first_frame)
      : grid_(&grid), first_(first), of_places_(of_places), first_frame_(first_frame) {}
  void rays(const TappedBatch&, std::uint32_t, std::uint32_t, std::span<const Ray>, std::span<const Hit>) override {}
  void numbers(const TappedBatch& batch, std::uint32_t ray, std::uint32_t first,
               std::span<const glm::vec4> numbers) override {
    if (!of_places_) keep(batch, ray, first, numbers);
  }
  void places(const TappedBatch& batch, std::uint32_t ray, std::uint32_t first,
              std::span<const glm::vec4> places) override {
    if (of_places_) keep(batch, ray, first, places);
  }
  void samples(const TappedBatch&, std::span<const glm::vec4>) override {}

 private:
  void keep(const TappedBatch& batch, std::uint32_t ray, std::uint32_t first, std::span<const glm::vec4> values) {
    if (ray != 1 || first != first_) return;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const glm::uvec2 pixel = batch.pixel(i);
      if (pixel.x >= static_cast<unsigned>(grid_->width) || pixel.y >= static_cast<unsigned>(grid_->height)) continue;
      const std::size_t at =
          (static_cast<std::size_t>(batch.frame(i) - first_frame_) * static_cast<std::size_t>(grid_->height) +
           pixel.y) *
              static_cast<std::size_t>(grid_->width) +
          pixel.x;
      grid_->values[at] = glm::dvec3(values[i]);
    }
  }
  PerturbationGrid* grid_;
  std::uint32_t first_;
  bool of_places_;
  std::uint32_t first_frame_;
};

}  // namespace

PerturbationSource tracer_perturbations(RandomKind random, const std::vector<ShaderPatch>& patches) {
  PerturbationSource source;
  source.name = std::string("tracer_") + name_of(random);
  // Three products and a cosine that is off by 2^-23 (shaders/elementary.glsl).
  source.rounding = 0x1p-21;
  source.take = [random, patches](CaseContext& context, const std::string& effect, Effects::Model model,
                                  std::uint64_t seed, int width, int height, std::uint32_t frames) {
    PerturbationGrid grid{width, height, frames, {}};
    grid.values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * frames);
    if (effect == "motion_blur") {
      for (std::uint32_t f = 0; f < frames; ++f)
        for (int i = 0; i < width * height; ++i)
          grid.values[static_cast<std::size_t>(f) * static_cast<std::size_t>(width * height) +
                      static_cast<std::size_t>(i)] = glm::dvec3(frame_time_number(seed, f), 0.0, 0.0);
      return grid;
    }
    RenderSettings settings;
    settings.width = width, settings.height = height;
    settings.seed = seed;
    settings.random = random;
    settings.patches = patches;
    settings.effects = Effects{};
    settings.effects->model = model;
    settings.effects->depth = 1;
    Renderer renderer(context.session.context(), wall(), settings);
    const std::uint32_t first = effect == "aa" ? 0 : effect == "dof" ? 2 : effect == "glossy" ? 5 : 8;
    Collector collector(grid, first, effect != "aa", 0);
    renderer.set_tap(&collector);
    renderer.add_frames(0, frames, [&](double share) {
      context.progress(share);
      return true;
    });
    return grid;
  };
  return source;
}

}  // namespace plumbline
