// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/closed_forms.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scenes/error.h"

namespace plumbline {

std::string ClosedFormInfo::name() const {
  return "drt.closed_form." + effect + "." + scene + (model == Effects::Model::physical ? ".physical" : ".paper");
}

std::vector<ClosedFormInfo> closed_forms() {
  std::vector<ClosedFormInfo> all;
  for (const auto& make : {soft_shadow_forms, depth_of_field_forms, glossy_forms, antialias_forms, motion_blur_forms})
    for (ClosedFormInfo& info : make()) all.push_back(std::move(info));
  return all;
}

ClosedForm with_slope(const ClosedFormInfo& info) {
  // The step is far above the quadrature's error and far below what the profile is curved over.
  constexpr double kStep = 0x1p-8;
  ClosedForm form = info.make(1.0);
  if (info.size.empty()) return form;
  const ClosedForm larger = info.make(1.0 + kStep);
  PLUMBLINE_ASSERT(larger.profile.pixels.size() == form.profile.pixels.size());
  for (std::size_t i = 0; i < form.profile.pixels.size(); ++i)
    form.profile.slope.push_back((larger.profile.pixels[i].mean - form.profile.pixels[i].mean) / kStep);
  return form;
}

void fill_pixels(Profile& profile, const std::function<std::pair<int, int>(int column, int row)>& like,
                 const std::function<SampleMoments(int column, int row)>& of) {
  std::map<std::pair<int, int>, std::size_t> numbers;
  std::vector<std::pair<int, int>> first;  // for each number a pixel that has it
  std::vector<std::size_t> number_of;
  for (int row = 0; row < profile.height; ++row)
    for (int column = 0; column < profile.width; ++column) {
      const auto [at, is_new] = numbers.try_emplace(like(column, row), first.size());
      if (is_new) first.emplace_back(column, row);
      number_of.push_back(at->second);
    }
  std::vector<SampleMoments> moments(first.size());
  tbb::parallel_for(std::size_t{0}, first.size(),
                    [&](std::size_t i) { moments[i] = of(first[i].first, first[i].second); });
  for (const std::size_t number : number_of) profile.pixels.push_back(moments[number]);
}

void gather_evenly(Profile& profile, int points, const std::function<double(int column, int row)>& place) {
  std::vector<std::pair<double, std::size_t>> order;
  for (int row = 0; row < profile.height; ++row)
    for (int column = 0; column < profile.width; ++column) order.emplace_back(place(column, row), order.size());
  std::sort(order.begin(), order.end());
  profile.point_of.resize(order.size());
  profile.place.assign(static_cast<std::size_t>(points), 0.0);
  std::vector<double> counts(profile.place.size(), 0.0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t point = i * profile.place.size() / order.size();
    profile.point_of[order[i].second] = static_cast<std::uint32_t>(point);
    profile.place[point] += order[i].first, counts[point] += 1.0;
  }
  for (std::size_t point = 0; point < counts.size(); ++point) profile.place[point] /= counts[point];
}

Scene scene_for(Effects::Model model, const glm::vec3& from, const glm::vec3& at, const glm::vec3& up, int width,
                int height, double pixel) {
  PLUMBLINE_ASSERT(height > 1);
  Scene scene;
  scene.name = "closed_form";
  scene.has_camera = true;
  scene.camera.from = from;
  scene.camera.at = at;
  scene.camera.up = up;
  scene.camera.width = width;
  scene.camera.height = height;
  scene.camera.angle_radians = static_cast<float>(2.0 * std::atan(0.5 * pixel * (height - 1)));
  scene.background = {1, 1, 1};
  scene.effects.model = model;
  scene.effects.antialias = scene.effects.soft_shadows = scene.effects.depth_of_field = false;
  scene.effects.motion_blur = scene.effects.glossy_reflections = false;
  scene.lights = {{{0, 0, -1000}, {1, 1, 1}, true, 0.0f}};
  return scene;
}

double pixel_of(const Camera& camera) {
  return 2.0 * std::tan(0.5 * static_cast<double>(camera.angle_radians)) / (camera.height - 1);
}

std::uint32_t add_white(Scene& scene) {
  scene.materials.push_back({.name = "white"});
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t add_black(Scene& scene) {
  scene.materials.push_back({.name = "black", .color = glm::vec3(0.0f), .diffuse = 0.0f});
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_quad(Scene& scene, const std::array<glm::vec3, 4>& corners, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
  for (const std::uint32_t middle : {1u, 2u})
    scene.triangles.push_back({.position = {first, first + middle, first + middle + 1}, .material = material});
}

}  // namespace plumbline
