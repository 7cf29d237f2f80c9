// SPDX-License-Identifier: MIT
#include "scenes/json_settings.h"

#include "scenes/camera.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

glm::vec3 read_color(const JsonPlace& place) {
  const glm::dvec3 color = place.vector();
  for (glm::length_t i = 0; i < 3; ++i) {
    if (color[i] < 0.0) place.fail("a colour must not be negative");
  }
  return glm::vec3(color);
}

constexpr double kHuge = 3e38;

Camera read_camera(const JsonPlace& place) {
  place.allow({"from", "at", "up", "angle", "width", "height", "hither", "aperture", "focus", "shutter"});
  Camera camera;
  camera.from = glm::vec3(place.need("from").vector());
  camera.at = glm::vec3(place.need("at").vector());
  if (const auto up = place.find("up")) camera.up = glm::vec3(up->vector());
  if (const auto angle = place.find("angle")) {
    const double degrees = angle->number();
    if (!(degrees > 0.0 && degrees < 180.0)) angle->fail("expected degrees above 0 and below 180");
    camera.angle_radians = static_cast<float>(glm::radians(degrees));
  }
  constexpr std::uint32_t kMostPixels = 16384;
  if (const auto width = place.find("width")) camera.width = static_cast<int>(width->integer(1, kMostPixels));
  if (const auto height = place.find("height")) camera.height = static_cast<int>(height->integer(1, kMostPixels));
  if (const auto hither = place.find("hither")) camera.hither = static_cast<float>(hither->number_between(0.0, kHuge));
  if (const auto aperture = place.find("aperture"))
    camera.aperture = static_cast<float>(aperture->number_between(0.0, kHuge));
  if (const auto focus = place.find("focus")) camera.focus = static_cast<float>(focus->number_between(0.0, kHuge));
  if (const auto shutter = place.find("shutter")) {
    shutter->check_array(2, 2);
    camera.shutter_open = static_cast<float>(shutter->at(0).number());
    camera.shutter_close = static_cast<float>(shutter->at(1).number());
    if (!(camera.shutter_open <= camera.shutter_close)) shutter->fail("the shutter must not close before it opens");
  }
  try {
    camera_frame(camera);
  } catch (const InputError& error) {
    std::string problem = error.what();
    if (problem.starts_with("camera: ")) problem.erase(0, 8);
    place.fail(problem);
  }
  return camera;
}

Light read_light(const JsonPlace& place) {
  place.allow({"position", "color", "radius"});
  Light light;
  light.position = glm::vec3(place.need("position").vector());
  if (const auto color = place.find("color")) {
    light.color = read_color(*color);
    light.has_color = true;
  }
  if (const auto radius = place.find("radius")) light.radius = static_cast<float>(radius->number_between(0.0, kHuge));
  return light;
}

Effects read_effects(const JsonPlace& place) {
  place.allow({"model", "antialias", "soft_shadows", "depth_of_field", "motion_blur", "glossy", "depth"});
  Effects effects;
  if (const auto model = place.find("model")) {
    if (model->text() != "paper" && model->text() != "physical") model->fail("expected \"paper\" or \"physical\"");
    effects.model = model->text() == "paper" ? Effects::Model::paper : Effects::Model::physical;
  }
  const auto read_switch = [&](const char* key, bool& value) {
    if (const auto found = place.find(key)) value = found->boolean();
  };
  read_switch("antialias", effects.antialias);
  read_switch("soft_shadows", effects.soft_shadows);
  read_switch("depth_of_field", effects.depth_of_field);
  read_switch("motion_blur", effects.motion_blur);
  if (const auto glossy = place.find("glossy")) effects.glossy = static_cast<float>(glossy->number_between(0.0, 1.0));
  if (const auto depth = place.find("depth")) effects.depth = depth->integer(0, 5);
  return effects;
}

}  // namespace

void read_settings(const JsonPlace& root, Settings& settings) {
  if (const auto camera = root.find("camera")) {
    settings.camera = read_camera(*camera);
    settings.has_camera = true;
  }
  if (const auto lights = root.find("lights")) {
    lights->check_array();
    for (std::size_t i = 0; i < lights->size(); ++i) settings.lights.push_back(read_light(lights->at(i)));
  }
  if (const auto background = root.find("background")) settings.background = read_color(*background);
  if (const auto effects = root.find("effects")) settings.effects = read_effects(*effects);
  for (const char* const key : {"$schema", "description"}) {
    if (const auto text = root.find(key)) text->text();
  }
}

void apply(const Settings& settings, Scene& scene) {
  scene.lights = settings.lights;
  scene.background = settings.background;
  scene.effects = settings.effects;
  scene.has_camera = settings.has_camera;
  if (settings.has_camera) {
    scene.camera = settings.camera;
  } else {
    frame_camera(scene);
  }
}

}  // namespace plumbline
