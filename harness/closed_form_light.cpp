// SPDX-License-Identifier: GPL-3.0-or-later
// Soft shadows: how much of a light is seen over an edge and over a disc, weighted by the cosine at which it arrives
// (closed_forms.md, section 1).
#include "harness/closed_forms.h"
#include "harness/quadrature.h"

namespace plumbline {
namespace {

constexpr double kPi = std::numbers::pi;

/// The cosine at the surface z = 0 of light from q, seen from (x, y, 0).
double cosine_of(const glm::dvec3& q, double x, double y) { return q.z / glm::length(q - glm::dvec3(x, y, 0.0)); }

template <class Integral>
LightMoments all_powers(Integral integral) {
  LightMoments moments;
  for (int power = 0; power < 4; ++power)
    moments[static_cast<std::size_t>(power)] = integral([power](double c) {
      double product = 1.0;
      for (int i = 0; i < power; ++i) product *= c;
      return product;
    });
  return moments;
}

/// Over the part of the unit ball with normal.p < bound: slices across the normal, circles in a slice.
template <class F>
double ball_cap_mean(F f, const glm::dvec3& normal, double bound) {
  constexpr int kAround = 24;  // of a periodic analytic function: exact beyond 1e-12
  const glm::dvec3 side = glm::normalize(glm::cross(normal, glm::dvec3(0, 1, 0)));
  const glm::dvec3 other = glm::cross(normal, side);
  const auto slice = [&](double s) {
    return integrate_smooth(
        [&](double share) {  // of the slice's area that lies within the circle
          const double radius = std::sqrt((1.0 - s * s) * share);
          double sum = 0.0;
          for (int i = 0; i < kAround; ++i) {
            const double angle = 2.0 * kPi * i / kAround;
            sum += f(s * normal + radius * (std::cos(angle) * side + std::sin(angle) * other));
          }
          return sum / kAround * kPi * (1.0 - s * s);
        },
        0.0, 1.0);
  };
  return integrate_smooth(slice, -1.0, std::clamp(bound, -1.0, 1.0)) / (4.0 / 3.0 * kPi);
}

/// Over the part of the cube with a p.x + c p.z < bound, a > 0.
template <class F>
double cube_part_mean(F f, double a, double c, double bound) {
  const auto end = [&](double z) { return (bound - c * z) / a; };
  const auto slice = [&](double z) {
    return integrate_smooth(
        [&](double x) { return integrate_smooth([&](double y) { return f(glm::dvec3(x, y, z)); }, -1.0, 1.0); }, -1.0,
        std::clamp(end(z), -1.0, 1.0));
  };
  std::vector<double> splits;
  if (c != 0.0) splits = {(bound - a) / c, (bound + a) / c};  // where the plane meets the sides x = 1 and x = -1
  std::erase_if(splits, [](double s) { return !(s > -1.0 && s < 1.0); });
  splits.push_back(1.0);
  std::sort(splits.begin(), splits.end());
  double sum = 0.0, left = -1.0;
  for (const double right : splits) sum += integrate_smooth(slice, left, right), left = right;
  return sum / 8.0;
}

/// A disc above the origin as it hides a light from (x, y, 0). At height z its shadow's outline, seen from there, is
/// the circle around -(x, y) t of radius `radius` (1 + t), with t = z / height - 1.
struct DiscOverPoint {
  double radius, height, x, y, center_height, size;

  double t_of(double z) const { return z / height - 1.0; }
  double z_of(double t) const { return height * (1.0 + t); }
};

/// Where the circle touches that of the ball's slice.
std::vector<double> ball_splits(const DiscOverPoint& d) {
  // (size^2 - (z - center)^2) = (|P| t +- radius (1 + t))^2, z = height (1 + t)
  const double distance = std::hypot(d.x, d.y), below = d.height - d.center_height;
  std::vector<double> splits;
  for (const double sign : {-1.0, 1.0}) {
    const double slope = distance + sign * d.radius, start = sign * d.radius;
    for (const double t : quadratic_roots(slope * slope + d.height * d.height, 2.0 * (slope * start + d.height * below),
                                          start * start + below * below - d.size * d.size))
      splits.push_back(d.z_of(t));
  }
  return splits;
}

/// Where the circle touches a side or meets a corner of the cube's slice.
std::vector<double> cube_splits(const DiscOverPoint& d) {
  std::vector<double> splits;
  for (const double place : {d.x, d.y})
    for (const double side : {-d.size, d.size})
      for (const double end : {-d.radius, d.radius})
        if (end != place) splits.push_back(d.z_of((side - end) / (end - place)));
  for (const double cx : {-d.size, d.size})
    for (const double cy : {-d.size, d.size})
      for (const double t :
           quadratic_roots(d.x * d.x + d.y * d.y - d.radius * d.radius,
                           2.0 * (d.x * cx + d.y * cy - d.radius * d.radius), cx * cx + cy * cy - d.radius * d.radius))
        splits.push_back(d.z_of(t));
  return splits;
}

/// Over what is seen of the slice at height z, whose half-width at abscissa x is `half(x)` for |x| <= widest. Lengths
/// along the direction away from the point for the ball, along the world's axes for the cube.
template <class F, class Half>
double seen_of_slice(F f, Half half, double widest, double ax, double ay, double radius, std::vector<double> splits,
                     double tolerance) {
  splits.insert(splits.end(), {ax - radius, ax + radius});
  const auto column = [&](double x) {
    const double edge = half(x), across = radius * radius - (x - ax) * (x - ax);
    const auto part = [&](double from, double to) {
      return integrate_smooth([&](double y) { return f(x, y); }, from, to);
    };
    if (!(across > 0.0)) return part(-edge, edge);
    const double hidden = std::sqrt(across);
    return part(-edge, std::min(ay - hidden, edge)) + part(std::max(ay + hidden, -edge), edge);
  };
  return integrate_pieces(column, -widest, widest, splits, tolerance);
}

double seen_ball(const DiscOverPoint& d, const std::function<double(double)>& power, double tolerance) {
  const double distance = std::hypot(d.x, d.y);
  const auto slice = [&](double z) {
    const double t = d.t_of(z), widest2 = d.size * d.size - (z - d.center_height) * (z - d.center_height);
    if (!(widest2 > 0.0)) return 0.0;
    // The axis of x points away from P, which stands at -distance; so does the circle's centre.
    const double widest = std::sqrt(widest2), ax = distance * t, radius = d.radius * (1.0 + t);
    std::vector<double> splits;
    if (ax > 0.0) splits.push_back((widest2 + ax * ax - radius * radius) / (2.0 * ax));
    return seen_of_slice(
        [&](double x, double y) { return power(z / std::sqrt(z * z + (x + distance) * (x + distance) + y * y)); },
        [&](double x) { return std::sqrt(std::max(0.0, widest2 - x * x)); }, widest, ax, 0.0, radius, splits,
        tolerance);
  };
  return integrate_pieces(slice, d.center_height - d.size, d.center_height + d.size, ball_splits(d), tolerance) /
         (4.0 / 3.0 * kPi * d.size * d.size * d.size);
}

double seen_cube(const DiscOverPoint& d, const std::function<double(double)>& power, double tolerance) {
  const auto slice = [&](double z) {
    const double t = d.t_of(z), ax = -d.x * t, ay = -d.y * t, radius = d.radius * (1.0 + t);
    std::vector<double> splits;
    for (const double side : {-d.size, d.size})
      if (const double rest = radius * radius - (side - ay) * (side - ay); rest > 0.0)
        splits.insert(splits.end(), {ax - std::sqrt(rest), ax + std::sqrt(rest)});
    return seen_of_slice(
        [&](double x, double y) { return power(z / std::sqrt(z * z + (x - d.x) * (x - d.x) + (y - d.y) * (y - d.y))); },
        [&](double) { return d.size; }, d.size, ax, ay, radius, splits, tolerance);
  };
  return integrate_pieces(slice, d.center_height - d.size, d.center_height + d.size, cube_splits(d), tolerance) /
         (8.0 * d.size * d.size * d.size);
}

constexpr int kSide = 24;    ///< of the pictures of discs, pixels
constexpr int kAcross = 16;  ///< points across the edge
constexpr float kLightHeight = 4.0f, kOccluderHeight = 2.0f;

/// The receiver z = 0, seen from (0, 0, 1), below whatever stands in the light.
Scene receiver_scene(Effects::Model model, double size, double pixel, int width) {
  Scene scene = scene_for(model, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}, width, kSide, pixel);
  scene.effects.soft_shadows = true;
  scene.lights = {{{0, 0, kLightHeight}, {1, 1, 1}, true, static_cast<float>(size)}};
  add_quad(scene, {glm::vec3{-8, -8, 0}, {8, -8, 0}, {8, 8, 0}, {-8, 8, 0}}, add_white(scene));
  return scene;
}

SampleMoments moments_of(const LightMoments& m) { return SampleMoments::from_raw({m[1], m[2], m[3]}); }

ClosedForm half_plane(Effects::Model model, double size) {
  constexpr double kPitch = 0.15;
  constexpr float kEdge = 0.03f;
  ClosedForm form;
  form.scene = receiver_scene(model, size, kPitch, kAcross);
  add_quad(form.scene,
           {glm::vec3{kEdge, -50, kOccluderHeight},
            {50, -50, kOccluderHeight},
            {50, 50, kOccluderHeight},
            {kEdge, 50, kOccluderHeight}},
           add_black(form.scene));
  const double pitch = pixel_of(form.scene.camera), light = static_cast<double>(form.scene.lights[0].radius);
  Profile& profile = form.profile;
  profile.width = kAcross, profile.height = kSide;
  const double middle = 0.5 * (kAcross - 1), center = 0.5 * (kSide - 1);
  // The scene is the same on both sides of y = 0.
  fill_pixels(
      profile, [](int column, int row) { return std::pair(column, std::min(row, kSide - 1 - row)); },
      [&](int column, int row) {
        return moments_of(light_over_half_plane(model, {0, 0, kLightHeight}, light, static_cast<double>(kEdge),
                                                kOccluderHeight, pitch * (column - middle), pitch * (center - row)));
      });
  for (int i = 0; i < kAcross * kSide; ++i) profile.point_of.push_back(static_cast<std::uint32_t>(i % kAcross));
  for (int column = 0; column < kAcross; ++column) profile.place.push_back(pitch * (column - middle));
  return form;
}

ClosedForm disc(Effects::Model model, double size, float radius, double wanted_pitch) {
  ClosedForm form;
  form.scene = receiver_scene(model, size, wanted_pitch, kSide);
  Ground& ground = form.scene.ground;
  ground.center = {0, 0, kOccluderHeight};
  ground.normal = {0, 0, 1};
  ground.v_axis = {0, 1, 0};
  ground.radius = radius;
  ground.material = add_black(form.scene);
  const double pitch = pixel_of(form.scene.camera), light = static_cast<double>(form.scene.lights[0].radius);
  Profile& profile = form.profile;
  profile.width = profile.height = kSide;
  const double center = 0.5 * (kSide - 1);
  // Disc, ball and cube are the same under the eight symmetries of the square.
  fill_pixels(
      profile,
      [](int column, int row) {
        const auto [low, high] = std::minmax({std::min(column, kSide - 1 - column), std::min(row, kSide - 1 - row)});
        return std::pair(low, high);
      },
      [&](int column, int row) {
        return moments_of(light_over_disc(model, kLightHeight, light, static_cast<double>(radius), kOccluderHeight,
                                          pitch * (column - center), pitch * (center - row)));
      });
  // A point is a ring.
  gather_evenly(profile, 16, [&](int column, int row) { return pitch * std::hypot(column - center, row - center); });
  return form;
}

}  // namespace

LightMoments light_over_half_plane(Effects::Model model, const glm::dvec3& center, double size, double edge,
                                   double height, double x, double y) {
  // The line from (x, y, 0) to Q passes x < edge at `height`: height Q.x + (x - edge) Q.z < height x.
  const glm::dvec3 across(height, 0.0, x - edge);
  const double bound = (height * x - glm::dot(across, center)) / size;
  return all_powers([&](auto power) {
    const auto f = [&](const glm::dvec3& p) { return power(cosine_of(center + size * p, x, y)); };
    if (model == Effects::Model::paper) return cube_part_mean(f, across.x, across.z, bound);
    const double length = glm::length(across);
    return ball_cap_mean(f, across / length, bound / length);
  });
}

LightMoments light_over_disc(Effects::Model model, double center_height, double size, double radius, double height,
                             double x, double y, double tolerance) {
  const DiscOverPoint d{radius, height, x, y, center_height, size};
  LightMoments moments;
  for (int power = 0; power < 4; ++power) {
    // Third moments only correct a skewness of some percent: four digits suffice.
    const double needed = power < 3 ? tolerance : 1e-6;
    const auto raise = [power](double c) {
      double product = 1.0;
      for (int i = 0; i < power; ++i) product *= c;
      return product;
    };
    moments[static_cast<std::size_t>(power)] =
        model == Effects::Model::paper ? seen_cube(d, raise, needed) : seen_ball(d, raise, needed);
  }
  return moments;
}

std::vector<ClosedFormInfo> soft_shadow_forms() {
  std::vector<ClosedFormInfo> forms;
  for (const auto model : {Effects::Model::paper, Effects::Model::physical}) {
    const std::string light = model == Effects::Model::paper ? "cube" : "ball";
    forms.push_back({"soft_shadow", "7.2", "half_plane", model, "light radius", "place across the edge (light radii)",
                     "From umbra to full light over an edge, the share of the light's " + light +
                         " that is seen, weighted by its cosine, is that of the analysis.",
                     [model](double size) { return half_plane(model, size); }});
    forms.push_back({"soft_shadow", "7.2", "disc_umbra", model, "light radius", "distance from the axis (light radii)",
                     "The shadow of a disc has the umbra and the penumbra of a light that is a " + light + ".",
                     [model](double size) { return disc(model, size, 0.8f, 0.15); }});
    forms.push_back(
        {"soft_shadow", "7.2", "disc_antumbra", model, "light radius", "distance from the axis (light radii)",
         "A disc smaller than its light leaves an antumbra, as bright as the rim of the " + light + " around it.",
         [model](double size) { return disc(model, size, 0.3f, 0.12); }});
  }
  return forms;
}

}  // namespace plumbline
