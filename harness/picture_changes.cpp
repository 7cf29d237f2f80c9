// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/picture_changes.h"

#include <algorithm>
#include <cmath>

#include "scenes/error.h"

namespace plumbline {
namespace {

class ChangedNumbers final : public RandomSource {
 public:
  ChangedNumbers(const PictureChange& change, std::uint64_t seed) : change_(change), own_(seed) {}
  void fill(const Draw& first, std::span<double> numbers) const override {
    Draw draw = first;
    if (change_.frame) draw.frame = change_.frame(draw.frame);
    if (change_.fill) {
      change_.fill(own_, draw, numbers);
    } else {
      own_.fill(draw, numbers);
    }
  }
  double time(std::uint32_t frame) const override {
    const double w = own_.time(frame);
    return change_.time ? change_.time(w) : w;
  }

 private:
  const PictureChange change_;
  const PhiloxSource own_;
};

class ChangedEngine final : public PictureEngine {
 public:
  ChangedEngine(const PictureChange& change, const Scene& scene, PictureSettings settings)
      : name_("reference with " + change.name),
        numbers_(change, settings.seed),
        scene_(scene),
        eight_bits_(change.eight_bits) {
    if (change.edit) change.edit(scene_, settings.effects);
    ReferenceSettings own;
    own.width = settings.width;
    own.height = settings.height;
    own.effects = settings.effects;
    own.time = settings.time;
    engine_ = reference_engine(scene_, own, &numbers_);
  }
  const std::string& name() const override { return name_; }
  PictureMoments render(std::uint32_t first_frame, std::uint32_t frames) override {
    PictureMoments moments = engine_->render(first_frame, frames);
    if (!eight_bits_) return moments;
    PictureMoments kept = engine_->render(first_frame, 1);
    const auto stored = [](double value) { return std::round(255.0 * std::clamp(value, 0.0, 1.0)) / 255.0; };
    for (std::uint32_t i = 0; i < frames; ++i) {
      const PictureMoments frame = engine_->render(first_frame + i, 1);
      for (std::size_t p = 0; p < kept.mean.size(); ++p)
        for (int c = 0; c < 3; ++c) {
          double& mean = kept.mean[p][c];
          mean = stored(mean + (frame.mean[p][c] - mean) / (i + 1.0));
        }
    }
    moments.mean = std::move(kept.mean);
    return moments;
  }

 private:
  const std::string name_;
  const ChangedNumbers numbers_;
  Scene scene_;
  const bool eight_bits_;
  std::unique_ptr<PictureEngine> engine_;
};

bool has_soft_light(const Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) { return light.radius > 0.0f; });
}
bool has_glossy(const Scene& scene, const Effects& effects) {
  return std::any_of(scene.materials.begin(), scene.materials.end(), [&](const Material& material) {
    return material.specular > 0.0f && (material.glossy >= 0.0f ? material.glossy : effects.glossy) > 0.0f;
  });
}
bool has_bounces(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& material) {
    return material.specular > 0.0f || material.transmittance > 0.0f;
  });
}

/// Means over 3 x 3 pixels: changes mostly reach further than a pixel, noise does not.
std::vector<glm::dvec3> blurred(const std::vector<glm::dvec3>& values, int width, int height) {
  std::vector<glm::dvec3> result;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      glm::dvec3 sum(0.0);
      int count = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u, ++count)
          sum += values[static_cast<std::size_t>(v * width + u)];
      result.push_back(sum / static_cast<double>(count));
    }
  return result;
}

}  // namespace

void scale_lights(Scene& scene, float by) {
  for (Light& light : scene.lights) light.radius *= by;
}
void scale_glossy(Scene& scene, Effects& effects, float by) {
  effects.glossy *= by;
  for (Material& material : scene.materials)
    if (material.glossy > 0.0f) material.glossy *= by;
}

PictureChange pixel_shift(const std::string& name, double x, double y) {
  PictureChange change;
  change.name = name;
  change.fill = [x, y](const RandomSource& own, const Draw& draw, std::span<double> numbers) {
    own.fill(draw, numbers);
    if (draw.dimension == 0 && numbers.size() == 2) numbers[0] += x, numbers[1] += y;
  };
  return change;
}

std::unique_ptr<PictureEngine> changed_engine(const PictureChange& change, const Scene& scene,
                                              const PictureSettings& settings) {
  return std::make_unique<ChangedEngine>(change, scene, settings);
}

std::vector<PictureChange> small_changes(const Scene& scene, const Effects& effects) {
  std::vector<PictureChange> changes;
  const auto add = [&](const std::string& name, const std::string& unit, double size,
                       std::function<void(Scene&, Effects&)> edit) {
    PictureChange change;
    change.name = name;
    change.unit = unit;
    change.size = size;
    change.edit = std::move(edit);
    changes.push_back(std::move(change));
  };
  const bool soft = effects.soft_shadows && has_soft_light(scene),
             lens = effects.depth_of_field && scene.camera.aperture > 0.0f,
             glossy = effects.glossy_reflections && has_glossy(scene, effects),
             moves = effects.motion_blur && !scene.animation.empty() &&
                     scene.camera.shutter_open != scene.camera.shutter_close;
  if (soft) add("light radius", "%", 25.0, [](Scene& s, Effects&) { scale_lights(s, 1.25f); });
  if (lens) add("aperture", "%", 25.0, [](Scene& s, Effects&) { s.camera.aperture *= 1.25f; });
  if (glossy) add("glossiness", "%", 25.0, [](Scene& s, Effects& e) { scale_glossy(s, e, 1.25f); });
  if (moves)
    add("end of the shutter", "%", 20.0,
        [](Scene& s, Effects&) { s.camera.shutter_close += 0.2f * (s.camera.shutter_close - s.camera.shutter_open); });
  if (effects.antialias)
    for (const bool across : {true, false}) {
      changes.push_back(
          pixel_shift(across ? "shift to the right" : "shift down", across ? 0.25 : 0.0, across ? 0.0 : 0.25));
      changes.back().unit = "pixels";
      changes.back().size = 0.25;
    }
  if (effects.depth > 0 && has_bounces(scene)) add("last bounce", "lost", 1.0, [](Scene&, Effects& e) { --e.depth; });
  if (soft || lens || glossy)
    add("model", "of the other", 1.0, [](Scene&, Effects& e) {
      e.model = e.model == Effects::Model::paper ? Effects::Model::physical : Effects::Model::paper;
    });
  return changes;
}

std::vector<Direction> directions_of(const std::vector<PictureChange>& changes, const Scene& scene,
                                     const PictureSettings& settings, std::uint32_t frames) {
  const std::uint32_t half = std::max(2u, frames / 2);
  const auto base = changed_engine({}, scene, settings);
  const PictureMoments first = base->render(0, half), second = base->render(half, half);
  // A pixel's weight is its change over its variance, as least squares wants it; a tenth of the mean variance keeps
  // pixels with little of it from ruling alone.
  glm::dvec3 floor(0.0);
  for (const glm::dvec3& v : first.variance) floor += 0.1 * v / static_cast<double>(first.variance.size());
  const double least = std::max({floor.x, floor.y, floor.z, 1e-12});
  std::vector<Direction> directions;
  for (const PictureChange& change : changes) {
    const auto engine = changed_engine(change, scene, settings);
    const PictureMoments changed_first = engine->render(0, half), changed_second = engine->render(half, half);
    Direction direction{change.name, change.unit, change.size, {}, {}};
    std::vector<glm::dvec3> seen;
    for (std::size_t i = 0; i < first.mean.size(); ++i) {
      seen.push_back(changed_first.mean[i] - first.mean[i]);
      direction.change.push_back(changed_second.mean[i] - second.mean[i]);
    }
    direction.weight = blurred(seen, first.width, first.height);
    double length = 0.0, noise = 0.0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      direction.weight[i] /= first.variance[i] + least;
      const double term = glm::dot(direction.weight[i], direction.change[i]);
      length += term;
      noise += term * term;
    }
    if (length > 4.0 * std::sqrt(noise)) directions.push_back(std::move(direction));
  }
  return directions;
}

}  // namespace plumbline
