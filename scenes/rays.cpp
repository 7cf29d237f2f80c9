// SPDX-License-Identifier: MIT
#include "scenes/rays.h"

#include <array>
#include <string>

#include "scenes/error.h"
#include "scenes/ray_sampler.h"

namespace plumbline {
namespace {

struct Entry {
  RayFamilyInfo info;
  RayMaker make;
};

// In the order of the enumeration: ray_family_info and generate_rays index by it.
constexpr std::array<Entry, 18> kEntries = {{
    {{RayFamily::camera, "camera", "through random points of all pixels of the scene's camera"}, make_camera},
    {{RayFamily::secondary, "secondary", "reflections and shadow rays that the renderer itself shot"}, make_secondary},
    {{RayFamily::chords, "chords", "between two random points of the bounding sphere"}, make_chord},
    {{RayFamily::aimed_vertices, "aimed_vertices", "at vertices of triangles and at poles of spheres"},
     make_aimed_vertex},
    {{RayFamily::aimed_edges, "aimed_edges", "at edges of triangles and at outlines of spheres"}, make_aimed_edge},
    {{RayFamily::aimed_inside, "aimed_inside", "1 to 64 units in the last place inside edges, vertices and outlines"},
     make_aimed_inside},
    {{RayFamily::aimed_outside, "aimed_outside",
      "1 to 64 units in the last place outside edges, vertices and outlines"},
     make_aimed_outside},
    {{RayFamily::tangents, "tangents",
      "tangents of bounding spheres and spheres, up to 64 units in the last place off"},
     make_tangent},
    {{RayFamily::in_plane, "in_plane", "within the plane of a triangle, through it and past it"}, make_in_plane},
    {{RayFamily::axis, "axis",
      "along coordinate axes, the other components +0 or -0, through vertices, centres and random points"},
     make_axis},
    {{RayFamily::inside, "inside", "from random points within the scene, within spheres and just behind surfaces"},
     make_inside},
    {{RayFamily::on_surface, "on_surface", "from points on surfaces, as a renderer's secondary rays start"},
     make_on_surface},
    {{RayFamily::far, "far", "from 10^3 to 10^6 scene radii away, aimed at the scene"}, make_far},
    {{RayFamily::scaled, "scaled",
      "with directions 1e-42 to 1e37 long and denormal components in direction and origin"},
     make_scaled},
    {{RayFamily::segments, "segments",
      "with t_max up to 8 units in the last place before, at and after the hit aimed at"},
     make_segment},
    {{RayFamily::undefined, "undefined", "with NaN or infinity in each place in turn, or a zero direction"},
     make_undefined},
    {{RayFamily::into_instances, "into_instances", "from within one instance into another", true}, make_into_instances},
    {{RayFamily::between_instances, "between_instances", "from one instance, or before it, to another", true},
     make_between_instances},
}};

constexpr std::array<RayFamilyInfo, kEntries.size()> kInfos = [] {
  std::array<RayFamilyInfo, kEntries.size()> infos = {};
  for (std::size_t i = 0; i < infos.size(); ++i) infos[i] = kEntries[i].info;
  return infos;
}();

constexpr bool in_enumeration_order() {
  for (std::size_t i = 0; i < kInfos.size(); ++i) {
    if (static_cast<std::size_t>(kInfos[i].family) != i) return false;
  }
  return true;
}
static_assert(in_enumeration_order());

/// The sum of areas of primitives first, ..., first + count - 1.
double area_of(const RaySource& source, std::uint32_t first, std::uint32_t count) {
  if (count == 0) return 0.0;
  return source.area_sum[first + count - 1] - (first > 0 ? source.area_sum[first - 1] : 0.0);
}

void find_places(RaySource& source) {
  const Scene& scene = *source.scene;
  const auto triangle_count = static_cast<std::uint32_t>(scene.triangles.size());
  double sum = 0.0;
  const auto add = [&](PlacedGeometry&& place) {
    // Areas grow by the square of a length; under a scale that is not uniform, of a mean one.
    double squares = 0.0;
    for (int i = 0; i < 3; ++i) squares += glm::dot(place.to_world.linear[i], place.to_world.linear[i]);
    const double area = area_of(source, place.first_triangle, place.triangle_count) +
                        area_of(source, triangle_count + place.first_sphere, place.sphere_count);
    source.placed_area_sum.push_back(sum += area * squares / 3.0);
    source.placed.push_back(std::move(place));
  };
  PlacedGeometry world;
  world.triangle_count = scene.world_triangle_count();
  world.sphere_count = scene.world_sphere_count();
  world.ball = source.ball;
  if (scene.nodes.empty() || world.triangle_count + world.sphere_count > 0) add(std::move(world));
  std::vector<Ball> of_parts;
  for (const Part& part : scene.parts) of_parts.push_back(bounding_ball(scene, part));
  for (const std::uint32_t instance : instances_of(scene)) {
    const std::uint32_t number = scene.nodes[instance].part;
    const Part& part = scene.parts[number];
    PlacedGeometry place;
    place.instance = instance;
    place.to_world = to_world(scene, instance);
    place.to_local = inverse(place.to_world);
    place.first_triangle = part.first_triangle;
    place.triangle_count = part.triangle_count;
    place.first_sphere = part.first_sphere;
    place.sphere_count = part.sphere_count;
    place.ball.center = transform_point(place.to_world, of_parts[number].center);
    place.ball.radius = largest_stretch(place.to_world.linear) * of_parts[number].radius;
    add(std::move(place));
  }
  if (source.placed.empty()) add(PlacedGeometry{});
}

}  // namespace

std::span<const RayFamilyInfo> ray_families() { return kInfos; }

const RayFamilyInfo& ray_family_info(RayFamily family) { return kInfos[static_cast<std::size_t>(family)]; }

RayFamily find_ray_family(std::string_view name) {
  std::string known;
  for (const RayFamilyInfo& info : kInfos) {
    if (info.name == name) return info.family;
    if (!known.empty()) known += ", ";
    known += info.name;
  }
  throw InputError("no ray family is called '" + std::string(name) + "'; there are " + known);
}

RaySource::RaySource(const Scene& scene_, std::vector<glm::vec4> node_spheres_)
    : scene(&scene_),
      ball(bounding_ball(scene_)),
      frame(camera_frame(scene_.camera)),
      node_spheres(std::move(node_spheres_)) {
  width = std::max(scene_.camera.width, 1);
  height = std::max(scene_.camera.height, 1);
  // A scene of one point has no size to choose eyes by; any will do.
  if (!(ball.radius > 0.0)) ball.radius = 1.0;
  area_sum.reserve(scene_.primitive_count());
  double sum = 0.0;
  for (std::uint32_t p = 0; p < scene_.primitive_count(); ++p) area_sum.push_back(sum += primitive_area(scene_, p));
  find_places(*this);
}

void RaySource::set_captured(std::vector<Ray> rays) {
  std::erase_if(rays, [](const Ray& ray) { return !is_defined(ray); });
  captured = std::move(rays);
}

void generate_rays(const RaySource& source, RayFamily family, std::uint64_t seed, std::uint64_t first_index,
                   std::span<Ray> out) {
  const Entry& entry = kEntries[static_cast<std::size_t>(family)];
  const bool is_undefined = family == RayFamily::undefined;
  const RayMaker make = placed_count(*source.scene) > 0 || is_undefined ? entry.make : make_chord;
  const std::uint64_t stream = name_hash(entry.info.name);
  for (std::size_t i = 0; i < out.size(); ++i) {
    RaySampler sampler(source, seed, stream, first_index + i);
    out[i] = make(sampler);
    // Scenes near the ends of the float range make some families overflow or cancel to nothing: the index keeps a ray.
    while (!is_undefined && !is_defined(out[i])) {
      out[i] = {glm::vec3(source.ball.center), glm::vec3(sampler.random().direction())};
    }
  }
}

}  // namespace plumbline
