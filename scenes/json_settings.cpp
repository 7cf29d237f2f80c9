// SPDX-License-Identifier: MIT
#include "scenes/json_settings.h"

#include <algorithm>

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
  // Rays start up to the aperture before the eye, and must all see what is sharp before them.
  if (!(static_cast<double>(camera.aperture) < focus_distance(camera)))
    place.need("aperture").fail("the lens must be smaller than the distance of what is sharp");
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
  place.allow(
      {"model", "antialias", "soft_shadows", "depth_of_field", "motion_blur", "glossy_reflections", "glossy", "depth"});
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
  read_switch("glossy_reflections", effects.glossy_reflections);
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

Ground read_ground(const JsonPlace& place, const NamedMaterials& materials, MeshPool& pool) {
  place.allow({"center", "normal", "radius", "texture_size", "material"});
  Ground ground;
  if (const auto center = place.find("center")) ground.center = glm::vec3(center->vector());
  glm::dvec3 normal(0.0, 1.0, 0.0);
  if (const auto given = place.find("normal")) {
    normal = given->vector();
    const glm::dvec3 size = glm::abs(normal);
    const double largest = std::max({size.x, size.y, size.z});
    if (!(largest > 0.0)) given->fail("a normal must not be zero");
    normal = glm::normalize(normal / largest);
  }
  // The texture's u runs along x as far as the plane lets it, or along z where the plane faces x.
  const glm::dvec3 size = glm::abs(normal);
  const glm::dvec3 along = size.x > size.y && size.x > size.z ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(along - glm::dot(along, normal) * normal);
  ground.normal = glm::vec3(normal);
  ground.u_axis = glm::vec3(u);
  ground.v_axis = glm::vec3(glm::cross(normal, u));
  const auto positive = [](const JsonPlace& number) {
    const auto value = static_cast<float>(number.number());
    if (!(value > 0.0f)) number.fail("expected a number above 0");
    return value;
  };
  ground.radius = positive(place.need("radius"));
  if (const auto texture_size = place.find("texture_size")) ground.texture_size = positive(*texture_size);
  const auto material = place.find("material");
  ground.material = material ? find_material(materials, *material) : pool.add_material(Material{});
  return ground;
}

void apply(const Settings& settings, Scene& scene) {
  scene.lights = settings.lights;
  scene.background = settings.background;
  scene.effects = settings.effects;
  scene.ground = settings.ground;
  scene.has_camera = settings.has_camera;
  if (settings.has_camera) {
    scene.camera = settings.camera;
  } else {
    frame_camera(scene);
  }
}

}  // namespace plumbline
