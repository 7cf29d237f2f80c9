// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/picture_faults.h"

#include <cmath>
#include <numbers>

namespace plumbline {
namespace {

constexpr std::uint32_t kLens = 2, kLight = 8;  ///< first dimensions, SEMANTICS 7.3

/// Numbers that in_ball takes to this place, which need not lie within the ball.
glm::dvec3 numbers_of_ball(const glm::dvec3& p) {
  const double length = glm::length(p);
  if (length == 0.0) return glm::dvec3(0.5, 0.0, 0.0);
  const double turns = std::atan2(p.y, p.x) / (2.0 * std::numbers::pi);
  return {0.5 * (1.0 - p.z / length), turns, length * length * length};
}

/// A change of the three numbers that make a perturbation of lights.
PictureChange light_numbers(const std::string& name, const std::function<glm::dvec3(const glm::dvec3&)>& change) {
  PictureChange fault;
  fault.name = name;
  fault.fill = [change](const RandomSource& own, const Draw& draw, std::span<double> numbers) {
    own.fill(draw, numbers);
    if (draw.dimension < kLight) return;
    const glm::dvec3 changed = change({numbers[0], numbers[1], numbers[2]});
    numbers[0] = changed.x, numbers[1] = changed.y, numbers[2] = changed.z;
  };
  return fault;
}

}  // namespace

std::vector<PictureFault> picture_faults() {
  const PictureFault soft{{}, {}, "soft_shadow", {"soft_shadow"}}, lens{{}, {}, "dof", {"dof"}},
      glossy{{}, {}, "glossy", {"glossy"}}, aa{{}, {}, "bumped_ground", {"aa"}},
      motion{{}, {}, "motion", {"motion_blur"}}, soft_and_lens{{}, {}, "figure_1", {"soft_shadow", "dof"}, 6},
      mirrors{{}, {}, "mirrors", {"aa"}, 12};
  std::vector<PictureFault> faults;
  const auto add = [&](PictureFault shown_by, PictureChange change, const std::string& what) {
    shown_by.change = std::move(change);
    shown_by.what = what;
    faults.push_back(std::move(shown_by));
  };
  const auto edit = [&](const PictureFault& shown_by, const std::string& name, const std::string& what,
                        std::function<void(Scene&, Effects&)> change) {
    PictureChange fault;
    fault.name = name;
    fault.edit = std::move(change);
    add(shown_by, std::move(fault), what);
  };
  edit(soft, "light_radius", "lights are 3 % too large", [](Scene& s, Effects&) { scale_lights(s, 1.03f); });
  edit(lens, "aperture", "the lens is 3 % too wide", [](Scene& s, Effects&) { s.camera.aperture *= 1.03f; });
  edit(glossy, "glossiness", "reflections are 5 % too rough", [](Scene& s, Effects& e) { scale_glossy(s, e, 1.05f); });
  edit(soft, "light_centre", "lights are points at their centres", [](Scene&, Effects& e) { e.soft_shadows = false; });
  edit(mirrors, "depth_4", "reflections end one bounce early", [](Scene&, Effects& e) { e.depth = 4; });
  add(soft, light_numbers("light_cube", [](const glm::dvec3& u) { return numbers_of_ball(2.0 * u - 1.0); }),
      "a cube of lights where the physical model has a ball");
  add(soft, light_numbers("light_surface", [](const glm::dvec3& u) { return glm::dvec3(u.x, u.y, 1.0); }),
      "lights are on the ball's surface, not in its volume");
  PictureChange fault;
  fault.name = "lens_no_root";
  fault.fill = [](const RandomSource& own, const Draw& draw, std::span<double> numbers) {
    own.fill(draw, numbers);
    if (draw.dimension == kLens) numbers[0] *= numbers[0];  // of which the square root is taken
  };
  add(lens, fault, "the physical lens is sampled by radius, without the square root");
  fault = {};
  fault.name = "light_is_lens";
  fault.fill = [](const RandomSource& own, const Draw& draw, std::span<double> numbers) {
    Draw from = draw;
    if (draw.dimension >= kLight) from.dimension = kLens, from.ray = 1;
    own.fill(from, numbers);
  };
  add(soft_and_lens, fault, "light and lens use the same random numbers");
  fault = {};
  fault.name = "noise_kept";
  fault.frame = [](std::uint32_t) { return 0u; };
  add(soft, fault, "the noise is not renewed: every frame has the numbers of the first");
  fault = {};
  fault.name = "noise_repeats";
  fault.frame = [](std::uint32_t frame) { return frame % 64; };
  add(soft, fault, "the noise comes again after 64 frames");
  fault = {};
  fault.name = "neighbours_share";
  fault.fill = [](const RandomSource& own, const Draw& draw, std::span<double> numbers) {
    Draw from = draw;
    from.x &= ~1u;
    own.fill(from, numbers);
  };
  add(soft, fault, "pairs of neighbouring pixels use the same random numbers");
  add(aa, pixel_shift("half_pixel", 0.5, 0.5), "samples are shifted by half a pixel");
  fault = {};
  fault.name = "half_shutter";
  fault.time = [](double w) { return 0.5 * w; };
  add(motion, fault, "the shutter is open in its first half only");
  fault = {};
  fault.name = "eight_bits";
  fault.eight_bits = true;
  add(soft, fault, "frames are averaged in 8 bits");
  return faults;
}

PictureComparison compare_with_fault(const PictureFault& fault, std::uint64_t seed) {
  const Scene scene = drt_scene(fault.scene);
  Depth depth;
  depth.frames = fault.frames;
  const auto faulty = [&](const Scene& s, const PictureSettings& settings) {
    return changed_engine(fault.change, s, settings);
  };
  return compare_engines(scene, effects_of(scene, fault.effects, Effects::Model::physical), depth, seed, faulty,
                         make_reference_engine);
}

}  // namespace plumbline
