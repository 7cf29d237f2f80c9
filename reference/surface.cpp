// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of triangles, spheres and the ground, each worked out in its own space and then taken to the world.
#include "reference/surface.h"

#include <algorithm>
#include <cmath>

#include "reference/texture_lookup.h"

namespace plumbline {

namespace {

/// What is known of a surface in the space of its part.
struct LocalSurface {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};   ///< geometric
  glm::dvec3 shading{0.0};  ///< m: interpolated, then bumped; on the side of `normal`
  glm::dvec3 reach{0.0};    ///< bound on the numbers that took part, by axis
  double size = 0.0;        ///< of a triangle: the longest side of the box around it
  bool has_uv = false;
  glm::dvec2 uv{0.0};
  glm::dvec3 along_u{0.0}, along_v{0.0};  ///< Pu and Pv; zero where coordinates do not span the surface
  std::uint32_t material = 0;
};

glm::dmat3 absolute(const glm::dmat3& m) { return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])}; }

double largest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

/// `vector` made of unit length; zero where it has none.
glm::dvec3 unit(const glm::dvec3& vector) {
  const double length = glm::length(vector);
  return length > 0.0 ? vector / length : glm::dvec3(0.0);
}

glm::dvec3 interpolated_normal(const Scene& scene, const Triangle& triangle, const glm::dvec3& weights,
                               const glm::dvec3& geometric) {
  if (triangle.normal[0] == kNone) return geometric;
  glm::dvec3 sum(0.0);
  for (int corner = 0; corner < 3; ++corner) {
    const glm::dvec3 normal = unit(glm::dvec3(scene.normals[triangle.normal[static_cast<std::size_t>(corner)]]));
    if (normal == glm::dvec3(0.0)) return geometric;
    sum += weights[corner] * normal;
  }
  const glm::dvec3 normal = unit(sum);
  if (normal == glm::dvec3(0.0)) return geometric;
  return glm::dot(normal, geometric) < 0.0 ? -normal : normal;
}

LocalSurface triangle_surface(const Scene& scene, std::uint32_t primitive, const glm::dvec2& barycentrics) {
  const Triangle& triangle = scene.triangles[primitive];
  const auto corners = scene.corners(primitive);
  const glm::dvec3 v0(corners[0]), v1(corners[1]), v2(corners[2]), e1 = v1 - v0, e2 = v2 - v0;
  const glm::dvec3 weights(1.0 - barycentrics.x - barycentrics.y, barycentrics.x, barycentrics.y);
  LocalSurface s;
  s.material = triangle.material;
  s.position = weights.x * v0 + weights.y * v1 + weights.z * v2;
  s.reach = glm::max(glm::max(glm::abs(v0), glm::abs(v1)), glm::abs(v2));
  s.size = largest(glm::max(glm::max(v0, v1), v2) - glm::min(glm::min(v0, v1), v2));
  s.normal = unit(glm::cross(e1, e2));
  s.shading = interpolated_normal(scene, triangle, weights, s.normal);
  if (triangle.texcoord[0] == kNone) return s;
  const glm::dvec2 t0(scene.texcoords[triangle.texcoord[0]]), t1(scene.texcoords[triangle.texcoord[1]]),
      t2(scene.texcoords[triangle.texcoord[2]]), d1 = t1 - t0, d2 = t2 - t0;
  s.has_uv = true;
  s.uv = weights.x * t0 + weights.y * t1 + weights.z * t2;
  const double determinant = d1.x * d2.y - d2.x * d1.y;
  if (determinant != 0.0) {
    s.along_u = (d2.y * e1 - d1.y * e2) / determinant;
    s.along_v = (d1.x * e2 - d2.x * e1) / determinant;
  }
  return s;
}

LocalSurface sphere_surface(const Sphere& sphere, const glm::dvec3& near) {
  const glm::dvec3 center(sphere.center);
  const auto radius = static_cast<double>(sphere.radius);
  LocalSurface s;
  s.material = sphere.material;
  s.normal = s.shading = unit(near - center);
  s.position = center + radius * s.normal;
  s.reach = glm::abs(center) + radius;
  return s;
}

LocalSurface ground_surface(const Ground& ground, const glm::dvec3& near) {
  const glm::dvec3 center(ground.center), normal(ground.normal);
  LocalSurface s;
  s.material = ground.material;
  s.normal = s.shading = normal;
  s.position = near - glm::dot(near - center, normal) * normal;
  s.reach = glm::max(glm::abs(center), glm::abs(s.position));
  s.has_uv = true;
  const auto size = static_cast<double>(ground.texture_size);
  s.along_u = size * glm::dvec3(ground.u_axis);
  s.along_v = size * glm::dvec3(ground.v_axis);
  s.uv = {glm::dot(s.position - center, glm::dvec3(ground.u_axis)) / size,
          glm::dot(s.position - center, glm::dvec3(ground.v_axis)) / size};
  return s;
}

/// Blinn 1978, as a surface gradient.
glm::dvec3 bumped(const LocalSurface& s, const Texture& heights, double scale) {
  const glm::dvec3& m = s.shading;
  const double area = glm::dot(m, glm::cross(s.along_u, s.along_v));
  if (!(std::fabs(area) > 0.0)) return m;
  const glm::dvec2 slopes = scale * height_slopes(heights, s.uv);
  const glm::dvec3 gradient = (slopes.x * glm::cross(s.along_v, m) + slopes.y * glm::cross(m, s.along_u)) / area;
  return unit(m - gradient);
}

}  // namespace

std::vector<InstanceView> instance_views(const Scene& scene) {
  std::vector<InstanceView> views(scene.nodes.size());
  for (const std::uint32_t instance : instances_of(scene)) {
    InstanceView& view = views[instance];
    view.to_world = to_world(scene, instance);
    view.from_world = inverse(view.to_world);
    view.normals = glm::transpose(view.from_world.linear);
    const glm::dmat3 both = absolute(view.to_world.linear) * absolute(view.from_world.linear);
    view.reach = both * absolute(view.to_world.linear);
    view.shift = both * glm::abs(view.to_world.translation);
  }
  return views;
}

std::optional<ReferenceHit> ground_hit(const Scene& scene, const Ray& ray) {
  const Ground& ground = scene.ground;
  if (!(ground.radius > 0.0f) || !is_defined(ray)) return std::nullopt;
  const glm::dvec3 origin(ray.origin), direction(ray.direction), center(ground.center), normal(ground.normal);
  const double slope = glm::dot(direction, normal), t = glm::dot(center - origin, normal) / slope;
  if (slope == 0.0 || !(t > 0.0 && t <= static_cast<double>(ray.t_max))) return std::nullopt;
  ReferenceHit hit;
  hit.position = origin + t * direction;
  if (!(glm::length(hit.position - center) <= static_cast<double>(ground.radius))) return std::nullopt;
  hit.kind = HitKind::hit;
  hit.primitive = ground_number(scene);
  hit.t = t;
  hit.normal = normal;
  return hit;
}

Surface surface_at(const Scene& scene, const std::vector<InstanceView>& views, const ReferenceHit& hit,
                   const glm::dvec3& direction) {
  const InstanceView* const view = hit.instance == kNone ? nullptr : &views[hit.instance];
  const glm::dvec3 near = view == nullptr ? hit.position : transform_point(view->from_world, hit.position);
  LocalSurface local = hit.primitive == ground_number(scene) ? ground_surface(scene.ground, near)
                       : scene.is_triangle(hit.primitive)    ? triangle_surface(scene, hit.primitive, hit.barycentrics)
                                                             : sphere_surface(scene.sphere(hit.primitive), near);
  Surface surface;
  surface.material = &scene.materials[local.material];
  const Material& material = *surface.material;
  surface.color = glm::dvec3(material.color);
  if (local.has_uv) {
    if (material.diffuse_texture != kNone)
      surface.color *= texture_value(scene.textures[material.diffuse_texture], local.uv);
    if (material.bump_texture != kNone)
      local.shading = bumped(local, scene.textures[material.bump_texture], static_cast<double>(material.bump_scale));
  }
  if (view == nullptr) {
    surface.position = local.position;
    surface.outside = local.normal;
    surface.shading = local.shading;
  } else {
    surface.position = transform_point(view->to_world, local.position);
    surface.outside = unit(view->normals * local.normal);
    surface.shading = unit(view->normals * local.shading);
    local.reach = view->reach * local.reach + view->shift;
    local.size *= largest(absolute(view->to_world.linear) * glm::dvec3(1.0));
  }
  surface.offset = 0x1p-17 * (glm::dot(glm::abs(surface.outside), local.reach) + local.size);
  const bool from_outside = glm::dot(direction, surface.outside) <= 0.0;
  surface.facing = from_outside ? surface.outside : -surface.outside;
  if (!from_outside) surface.shading = -surface.shading;
  return surface;
}

}  // namespace plumbline
