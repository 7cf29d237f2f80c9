// SPDX-License-Identifier: GPL-3.0-or-later
// The derivation, for u = 2^-24. A sample is a chain: random numbers give the primary ray, a ray gives a hit, a hit a
// surface, a surface shadow rays, light and further rays. The taps tell every ray and every hit, so each link is
// checked by itself: what the tracer had in hand before the step, as exact numbers, goes through the formulas of
// SEMANTICS in double, and what the tracer made of it may differ by the rounding of this one step. Nothing grows from
// bounce to bounce, and no condition number of a whole path is needed: where all links hold the sample is the right one
// for rays that differ from the exact ones by rounding, and where one does not it is known which. Errors are lengths of
// vectors; each operation on a float is off by u of its result, products by vectors of length 1 by at most sqrt(3) u,
// and we count operations generously: a fault on purpose is 10^3 of these or more (paired_test.cpp).
//
// unit(v) (unit.glsl): scaling 2u, three products and two sums 3u, halved by the root, root, quotient and product 3u:
// at most kUnit = 8u with an error e of v before it: e / |v| + 8u.
//
// Primary ray. The place x - 1/2 + a - centre has three roundings of numbers below W + H + 2: 3u (W + H + 2); times the
// pixel's side. Axes, side, focus and aperture are rounded once: 6u of each vector's length. A lens shift has p off by
// kBody and 6u beside it.
//
// p (SEMANTICS 7.4) of a cube is exact: 2u - 1 is. Of a ball or disc: cube root 2u, root of the product 3u, cosine and
// sine 2u each (elementary.glsl), products 3u: at most kBody = 16u.
//
// Surface. Position, normal and weights are the tracer's own, judged before by value_bounds. The shading normal of a
// triangle with normals n_i: w_0 = 1 - w_1 - w_2 has 2u, the stored n_i 2u, products and sums 3u: 8u / |sum| + kUnit.
// Into and out of an instance's space: 6u of |L^-T| |m| over |L^-T m|. (u, v): 6u of the largest coordinate, then w
// (that + 2u) + u texels. A bilinear value changes by no more for a texel's way than the steepest pair of neighbours
// within reach, its slopes by the largest change of a central difference from texel to texel, times half the texture's
// size; 6u of the values beside it. The bump's gradient G = (F_u Pv x m + F_v m x Pu) / A, with kappa = |Pu| |Pv| /
// |A|: (dF_u |Pv| + dF_v |Pu|) / |A| + (2 kappa dm + 16u (kappa + kappa_D)) (|F_u| |Pv| + |F_v| |Pu|) / |A|, kappa_D
// being what D and the differences of coordinates cancel. n = unit(m - G).
//
// delta needs three digits (SEMANTICS 6.5): 2^-10 of it; and what N, by which it is measured, may differ.
//
// Ground. t = (c - o).N / d.N has 4u |c - o|.|N| / |d.N| + 4u |t| |d|.|N| / |d.N| + 2u |t|, bars meaning absolute
// values of components: nothing where the ray starts in a plane along the axes. The place has that, 4u (|o - c| + t)
// for itself, and 6u of its way from c for moving it into the plane.
//
// Light. q = place + R p: sqrt(3) u |q| + R (kBody + 2u). l = unit(q - P): dl = (dq + dP + 2u |q - P|) / |q - P| +
// kUnit. n.l: dn + dl + 4u. h = unit(l - d): dh = (dl + 6u) / |l - d| + kUnit, since d is off unit length by 3u. x =
// n.h: e = dn + dh + 4u; the highlight x^y: from (x - e)^y to (x + e)^y, and x^y (2 + 4 y |ln x|) u of power().
//
// Reflected ray: n_p = unit(n + g p): (dn + g kBody + 4u) / |n + g p| + kUnit. r = d - 2 (d.n_p) n_p: 4 dn_p + 12u;
// mirrored above the surface: 12u; unit. Refracted: c: dn + 6u; k = 1 - eta^2 (1 - c^2): dk = eta^2 (2 |c| dc + dc^2 +
// 8u) + 3u; root s: ds = the larger way from s to sqrt(k +- dk), and u; r: eta dc + ds + |eta c - s| dn + 8u (1 + eta);
// mirrored 12u; unit. Starts: dP + ddelta + 4u (|P| + delta).
//
// Choices that 32 bits do not settle are told: those whose deciding number is within its own bound of the limit.
#include "harness/paired_bounds.h"

#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

constexpr double u = 0x1p-24;
constexpr double kUnit = 8.0 * u, kBody = 16.0 * u, kDelta = 0x1p-10;

bool is_physical(const SampleNumbers& n) { return n.prepared.effects.model == Effects::Model::physical; }

double largest(const glm::dvec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

/// What the tracer interpolates on a triangle, in its part's space.
struct LocalTriangle {
  glm::dvec3 m{0.0};  ///< the normal before it is bumped, on the side of the geometric one
  double m_error = 0.0;
  bool is_flat = true, is_near_turning = false;
  bool has_uv = false;
  glm::dvec2 uv{0.0};
  double uv_size = 0.0;  ///< of the largest coordinate
  glm::dvec3 along_u{0.0}, along_v{0.0};
  double cancelled = 1.0;  ///< how much their computation cancels
};

LocalTriangle local_triangle(const Scene& scene, std::uint32_t primitive, const glm::dvec2& b) {
  const Triangle& triangle = scene.triangles[primitive];
  const auto v = scene.corners(primitive);
  const glm::dvec3 weights(1.0 - b.x - b.y, b.x, b.y), e1 = glm::dvec3(v[1]) - glm::dvec3(v[0]),
                                                       e2 = glm::dvec3(v[2]) - glm::dvec3(v[0]);
  LocalTriangle t;
  const glm::dvec3 normal = glm::normalize(glm::cross(e1, e2));
  t.m = normal;
  if (triangle.normal[0] != kNone) {
    glm::dvec3 sum(0.0);
    bool is_whole = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 n(scene.normals[triangle.normal[i]]);
      is_whole = is_whole && n != glm::dvec3(0.0);
      if (n != glm::dvec3(0.0)) sum += weights[static_cast<int>(i)] * glm::normalize(n);
    }
    const double length = glm::length(sum);
    if (is_whole && length > 0.0) {
      t.is_flat = false;
      t.m_error = 8.0 * u / length + kUnit;
      const double across = glm::dot(sum / length, normal);
      t.is_near_turning = std::fabs(across) <= t.m_error + kUnit;
      t.m = across < 0.0 ? -sum / length : sum / length;
    }
  }
  if (triangle.texcoord[0] == kNone) return t;
  std::array<glm::dvec2, 3> at;
  for (std::size_t i = 0; i < 3; ++i) {
    at[i] = glm::dvec2(scene.texcoords[triangle.texcoord[i]]);
    t.uv_size = std::max({t.uv_size, std::fabs(at[i].x), std::fabs(at[i].y)});
  }
  t.has_uv = true;
  t.uv = weights.x * at[0] + weights.y * at[1] + weights.z * at[2];
  const glm::dvec2 d1 = at[1] - at[0], d2 = at[2] - at[0];
  const double area = d1.x * d2.y - d2.x * d1.y;
  if (area == 0.0) return t;
  t.along_u = (d2.y * e1 - d1.y * e2) / area;
  t.along_v = (d1.x * e2 - d2.x * e1) / area;
  const double ways = (glm::length(d1) + glm::length(d2)) * (glm::length(e1) + glm::length(e2)) / std::fabs(area);
  t.cancelled = (std::fabs(d1.x * d2.y) + std::fabs(d2.x * d1.y)) / std::fabs(area) +
                ways / std::max(glm::length(t.along_u), 1e-300) + ways / std::max(glm::length(t.along_v), 1e-300);
  return t;
}

/// Largest difference of neighbouring texels within reach of a bilinear lookup and of its central differences, and
/// their largest value, by channel; and by how much a central difference changes from one texel to the next.
struct Steepness {
  glm::dvec3 difference{0.0}, value{0.0};
  double curvature = 0.0;
};
Steepness steepness(const Texture& texture, const glm::dvec2& uv) {
  const auto wrapped = [](int i, int size) { return ((i % size) + size) % size; };
  const auto texel = [&](int i, int j) {
    return glm::dvec3(
        texture.texels[static_cast<std::size_t>(wrapped(j, texture.height)) * static_cast<std::size_t>(texture.width) +
                       static_cast<std::size_t>(wrapped(i, texture.width))]);
  };
  const int i = static_cast<int>(std::floor((uv.x - std::floor(uv.x)) * texture.width - 0.5)),
            j = static_cast<int>(std::floor((1.0 - (uv.y - std::floor(uv.y))) * texture.height - 0.5));
  Steepness s;
  for (int y = j - 2; y <= j + 3; ++y)
    for (int x = i - 2; x <= i + 3; ++x) {
      const glm::dvec3 here = texel(x, y);
      s.value = glm::max(s.value, glm::abs(here));
      s.difference = glm::max(s.difference, glm::abs(texel(x + 1, y) - here));
      s.difference = glm::max(s.difference, glm::abs(texel(x, y + 1) - here));
    }
  const auto slope = [&](int x, int y, int dx, int dy) { return texel(x + dx, y + dy).x - texel(x - dx, y - dy).x; };
  for (int y = j - 1; y <= j + 2; ++y)
    for (int x = i - 1; x <= i + 2; ++x)
      for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}})
        s.curvature = std::max({s.curvature, std::fabs(slope(x + 1, y, dx, dy) - slope(x, y, dx, dy)),
                                std::fabs(slope(x, y + 1, dx, dy) - slope(x, y, dx, dy))});
  return s;
}

/// Errors of texture coordinates, in texels.
glm::dvec2 texel_error(const Texture& texture, double uv_error) {
  return glm::dvec2(texture.width, texture.height) * (uv_error + 2.0 * u) + u;
}

void bound_color(const Scene& scene, const Material& material, const glm::dvec2& uv, double uv_error,
                 SeenSurface& seen) {
  seen.color = 2.0 * u * seen.surface.color;
  if (material.diffuse_texture == kNone) return;
  const Texture& texture = scene.textures[material.diffuse_texture];
  const Steepness s = steepness(texture, uv);
  const glm::dvec2 off = texel_error(texture, uv_error);
  seen.color = glm::dvec3(material.color) * (s.difference * (off.x + off.y) + 8.0 * u * s.value);
}

/// What bumping makes of an error of m, and what it adds.
double bumped_error(const Texture& heights, double scale, const glm::dvec2& uv, double uv_error, const LocalTriangle& t,
                    double m_error) {
  const glm::dvec3 normal = glm::cross(t.along_u, t.along_v);
  const double area = std::fabs(glm::dot(t.m, normal));
  if (!(area > 0.0)) return m_error;
  const Steepness s = steepness(heights, uv);
  const glm::dvec2 off = texel_error(heights, uv_error), size(heights.width, heights.height);
  const double lu = glm::length(t.along_u), lv = glm::length(t.along_v), kappa = lu * lv / area;
  // A slope is at most one texel's difference to each side, hence twice the steepest one, halved.
  const glm::dvec2 slope = std::fabs(scale) * size * s.difference.x,
                   slope_error = 0.5 * std::fabs(scale) * size * s.curvature * (off.x + off.y) +
                                 0.5 * std::fabs(scale) * size * (8.0 * u * s.value.x);
  const double gradient = (slope.x * lv + slope.y * lu) / area,
               gradient_error = (slope_error.x * lv + slope_error.y * lu) / area +
                                gradient * (2.0 * kappa * m_error + 16.0 * u * (kappa + t.cancelled));
  // |m - G| >= 1 where G lies across m, as it does but for the slant of interpolated normals.
  return (m_error + gradient_error) * std::max(1.0, kappa) + kUnit;
}

/// The shading normal taken into an instance's space and out of it again.
double placed_error(const InstanceView& view, double local_error, const glm::dvec3& outside) {
  const glm::dmat3& out = view.normals;
  const glm::dmat3 in = glm::transpose(view.to_world.linear);
  const auto size = [](const glm::dmat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
  };
  const double least_in = glm::length(in * outside), least_out = 1.0 / size(in);
  return (local_error + 6.0 * u * size(in) / least_in + kUnit) * size(out) / std::max(least_out, 1e-300) +
         6.0 * u * size(out) / std::max(least_out, 1e-300) + kUnit;
}

double start_error(const SeenSurface& seen) {
  return seen.position + seen.offset +
         4.0 * u * (std::sqrt(3.0) * largest(seen.surface.position) + seen.surface.offset);
}

std::string near_limit(const char* what, double value, double bound) {
  char text[96];
  std::snprintf(text, sizeof text, "%s is %.2g, known to %.2g", what, value, bound);
  return text;
}

}  // namespace

RayBounds primary_bounds(const SampleNumbers& n) {
  const Camera& camera = n.prepared.scene->camera;
  const CameraFrame& frame = n.prepared.camera;
  const double sides = camera.width + camera.height + 2.0;
  const double slope = frame.pixel * std::hypot(n.sample.x - frame.centre_x, n.sample.y - frame.centre_y),
               through = 3.0 * u * sides * frame.pixel * std::sqrt(2.0) + 6.0 * u * (1.0 + slope + frame.pixel);
  RayBounds b;
  const double aperture = n.prepared.effects.depth_of_field ? n.prepared.aperture : 0.0;
  if (!(aperture > 0.0)) {
    b.direction = through + kUnit;  // the vector through the pixel is never shorter than 1
    return b;
  }
  const double shift = aperture * std::sqrt(3.0) * ((is_physical(n) ? kBody : 0.0) + 6.0 * u);
  b.origin = shift + 2.0 * u * std::sqrt(3.0) * (largest(frame.from) + aperture);
  b.direction =
      (n.prepared.focus * (through + 2.0 * u * (1.0 + slope)) + shift) / std::max(n.prepared.focus - aperture, 1e-300) +
      kUnit;
  return b;
}

SeenGround meet_ground(const Scene& scene, const Ray& ray) {
  SeenGround seen;
  const Ground& ground = scene.ground;
  if (!(ground.radius > 0.0f)) return seen;
  seen.hit = ground_hit(scene, ray);
  const glm::dvec3 o(ray.origin), d(ray.direction), c(ground.center), normal(ground.normal);
  const double along = glm::dot(d, normal), above = glm::dot(c - o, normal), way = glm::length(o - c);
  const double length = glm::length(d), along_error = 4.0 * u * glm::dot(glm::abs(d), glm::abs(normal)),
               above_error = 4.0 * u * glm::dot(glm::abs(c - o), glm::abs(normal));
  if (above_error == 0.0 || along_error == 0.0) return seen;  // exactly in the plane, or along it
  if (!(std::fabs(along) > along_error)) {
    seen.undecided = near_limit("the ray's slope to the ground", along, along_error);
    return seen;
  }
  const double t = above / along;
  seen.t = (above_error + along_error * std::fabs(t)) / (std::fabs(along) - along_error) + 2.0 * u * std::fabs(t);
  const double place = seen.t * length + 6.0 * u * (way + std::fabs(t) * length),
               rim = glm::length(o + t * d - c) - static_cast<double>(ground.radius);
  if (!(rim <= place) || !(t > -seen.t) || !(t <= static_cast<double>(ray.t_max) + seen.t)) return seen;
  if (rim >= -place)
    seen.undecided = near_limit("the way to the ground's rim", rim, place);
  else if (t <= seen.t)
    seen.undecided = near_limit("t of the ground", t, seen.t);
  else if (t >= static_cast<double>(ray.t_max) - seen.t)
    seen.undecided = near_limit("t of the ground less t_max", t - static_cast<double>(ray.t_max), seen.t);
  return seen;
}

SeenSurface see_ground(const PreparedScene& prepared, const Ray& ray, const ReferenceHit& hit) {
  const Scene& scene = *prepared.scene;
  const Ground& ground = scene.ground;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(ray.direction)), center(ground.center);
  SeenSurface seen;
  seen.surface = surface_at(scene, prepared.views, hit, direction);
  const SeenGround met = meet_ground(scene, ray);
  const double way = glm::length(glm::dvec3(ray.origin) - center), from_center = glm::length(hit.position - center);
  seen.position = met.t + 4.0 * u * (way + hit.t) + 6.0 * u * from_center + 2.0 * u * glm::length(hit.position);
  seen.offset = kDelta * seen.surface.offset;
  const auto size = static_cast<double>(ground.texture_size);
  const Material& material = *seen.surface.material;
  const glm::dvec3 from = seen.surface.position - center;
  LocalTriangle plane;
  plane.m = glm::dvec3(ground.normal);
  plane.uv = {glm::dot(from, glm::dvec3(ground.u_axis)) / size, glm::dot(from, glm::dvec3(ground.v_axis)) / size};
  plane.along_u = size * glm::dvec3(ground.u_axis), plane.along_v = size * glm::dvec3(ground.v_axis);
  const double uv_error = (seen.position + 6.0 * u * from_center) / size;
  bound_color(scene, material, plane.uv, uv_error, seen);
  seen.shading = kUnit;
  if (material.bump_texture != kNone)
    seen.shading = bumped_error(scene.textures[material.bump_texture], static_cast<double>(material.bump_scale),
                                plane.uv, uv_error, plane, kUnit);
  return seen;
}

SeenSurface see_surface(const PreparedScene& prepared, const BoundsContext& context, const Ray& ray, const Hit& hit) {
  const Scene& scene = *prepared.scene;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(ray.direction));
  const ReferenceHit told{hit.kind,
                          hit.primitive,
                          hit.instance,
                          static_cast<double>(hit.t),
                          glm::dvec3(hit.position),
                          glm::dvec3(hit.normal),
                          glm::dvec2(hit.barycentrics)};
  SeenSurface seen;
  Surface& s = seen.surface;
  s = surface_at(scene, prepared.views, told, direction);
  const glm::dvec3 normal = glm::normalize(told.normal);
  const double apart = glm::length(normal - s.outside);
  const bool is_flat = s.shading == s.facing;
  s.position = told.position;
  s.outside = normal;
  const double across = glm::dot(direction, normal);
  if (std::fabs(across) <= apart + kUnit)
    seen.undecided = near_limit("d.N, which tells the sides,", across, apart + kUnit);
  s.facing = across <= 0.0 ? normal : -normal;
  if (is_flat) s.shading = s.facing;
  const Ball& ball = context.world.ball;
  seen.offset = kDelta * s.offset + 0x1p-17 * apart * std::sqrt(3.0) * (glm::length(ball.center) + ball.radius);

  const Material& material = *s.material;
  seen.color = 2.0 * u * s.color;
  const bool is_triangle = scene.is_triangle(hit.primitive);
  double local_error = is_flat ? 0.0 : apart;
  if (is_triangle) {
    const LocalTriangle t = local_triangle(scene, hit.primitive, told.barycentrics);
    if (t.is_near_turning) seen.undecided = "the interpolated normal is square to the geometric one";
    if (!t.is_flat) local_error = t.m_error;
    if (t.has_uv) {
      const double uv_error = 6.0 * u * t.uv_size;
      bound_color(scene, material, t.uv, uv_error, seen);
      if (material.bump_texture != kNone)
        local_error = bumped_error(scene.textures[material.bump_texture], static_cast<double>(material.bump_scale),
                                   t.uv, uv_error, t, local_error + kUnit);
    }
  }
  seen.shading =
      hit.instance == kNone ? local_error + kUnit : placed_error(prepared.views[hit.instance], local_error, normal);
  return seen;
}

SeenLight see_light(const SampleNumbers& n, const SeenSurface& seen, const glm::dvec3& direction, std::uint32_t ray,
                    std::uint32_t k) {
  const Scene& scene = *n.prepared.scene;
  const Light& light = scene.lights[k];
  const Surface& s = seen.surface;
  SeenLight l;
  const glm::dvec3 place = light_place(n, ray, k), way = place - s.position;
  l.outcome = faces_light(s, place);
  if (l.outcome == LightOutcome::at_light) return l;
  const double radius = n.prepared.effects.soft_shadows ? static_cast<double>(light.radius) : 0.0,
               place_error = std::sqrt(3.0) * u * largest(place) +
                             radius * std::sqrt(3.0) * ((is_physical(n) ? kBody : 0.0) + 2.0 * u),
               distance = glm::length(way),
               l_error = (place_error + seen.position + 2.0 * u * distance) / distance + kUnit;
  const glm::dvec3 to_light = way / distance;
  const double above = glm::dot(s.facing, to_light), above_error = l_error + kUnit,
               along = glm::dot(s.shading, to_light), along_error = seen.shading + l_error + 4.0 * u;
  if (std::fabs(above) <= above_error)
    l.undecided = near_limit("n_g.l", above, above_error);
  else if (above > 0.0 && std::fabs(along) <= along_error)
    l.undecided = near_limit("n.l", along, along_error);
  if (l.outcome != LightOutcome::lit) return l;
  l.shadow = shadow_ray(s, place);
  l.shadow_bounds.origin = start_error(seen);
  l.shadow_bounds.direction = place_error + start_error(seen) + 2.0 * u * distance + 2.0 * u * largest(place);

  const Material& material = *s.material;
  const glm::dvec3 brightness = brightness_of(scene, light);
  const auto kd = static_cast<double>(material.diffuse), ks = static_cast<double>(material.specular),
             y = std::max(static_cast<double>(material.shine), 0.0);
  l.brought = brightness * shine(s, place, direction);
  glm::dvec3 error = kd * (along_error * s.color + along * seen.color);
  if (ks > 0.0) {
    const glm::dvec3 half = to_light - direction;
    const double length = glm::length(half), x = glm::dot(s.shading, half) / length,
                 e = seen.shading + (l_error + 6.0 * u) / length + kUnit + 4.0 * u;
    const auto highlight = [&](double cosine) { return cosine > 0.0 ? std::pow(cosine, y) : 0.0; };
    const double value = highlight(x);
    const double own = x > 0.0 ? value * (2.0 + 4.0 * y * std::fabs(std::log(std::min(x, 1.0)))) * u : 0.0;
    const double up = highlight(x + e) - value, down = value - highlight(x - e);
    // A half vector of no length has no direction at all.
    error += ks * (length > l_error ? std::max(up, down) + own : 1.0);
  }
  l.brought_bounds = brightness * error + 12.0 * u * l.brought;
  return l;
}

SeenRay see_reflected(const SampleNumbers& n, const SeenSurface& seen, const PathRay& path) {
  SeenRay r;
  r.ray = reflected_ray(n, seen.surface, path);
  const glm::dvec3 shift = normal_perturbation(n, seen.surface, path.number);
  double normal = seen.shading;
  if (shift != glm::dvec3(0.0)) {
    const double length = glm::length(seen.surface.shading + shift), size = glm::length(shift);
    normal =
        (seen.shading + size * (is_physical(n) ? 2.0 * kBody : 4.0 * u) + 4.0 * u) / std::max(length, 1e-300) + kUnit;
  }
  r.bounds = {start_error(seen), std::min(2.0, 4.0 * normal + 24.0 * u + kUnit)};
  return r;
}

SeenRay see_refracted(const SeenSurface& seen, const PathRay& path) {
  SeenRay r;
  RayEvent event;
  r.ray = refracted_ray(seen.surface, path, &event);
  const Surface& s = seen.surface;
  const auto told = static_cast<double>(s.material->refraction_index);
  const double index = told > 0.0 ? told : 1.0;
  const double eta = glm::dot(path.direction, s.outside) <= 0.0 ? 1.0 / index : index;
  const double c = -glm::dot(path.direction, s.shading), k = 1.0 - eta * eta * (1.0 - c * c);
  const double c_error = seen.shading + 6.0 * u,
               k_error = eta * eta * (2.0 * std::fabs(c) * c_error + c_error * c_error + 8.0 * u) + 3.0 * u;
  if (std::fabs(k) <= k_error) r.undecided = near_limit("k of total reflection", k, k_error);
  double direction = 4.0 * seen.shading + 24.0 * u;
  if (!event.totally_reflected) {
    const double root = std::sqrt(std::max(k, 0.0)), up = std::sqrt(std::max(k + k_error, 0.0)) - root,
                 down = root - std::sqrt(std::max(k - k_error, 0.0));
    direction = eta * c_error + std::max(up, down) + std::fabs(eta * c - root) * seen.shading + 8.0 * u * (1.0 + eta) +
                12.0 * u;
  }
  r.bounds = {start_error(seen), std::min(2.0, direction + kUnit)};
  return r;
}

}  // namespace plumbline
