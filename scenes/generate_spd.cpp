// SPDX-License-Identifier: MIT
#include "scenes/generate_spd.h"

#include <algorithm>
#include <cmath>

#include "scenes/builder.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double kPi = 3.141592653589793;

void set_view(Scene& scene, const glm::dvec3& from, const glm::dvec3& at, const glm::dvec3& up, double hither) {
  scene.background = {0.078f, 0.361f, 0.753f};  // "UNC sky blue", of all SPD scenes
  scene.camera.from = glm::vec3(from);
  scene.camera.at = glm::vec3(at);
  scene.camera.up = glm::vec3(up);
  scene.camera.angle_radians = static_cast<float>(kPi / 4.0);
  scene.camera.hither = static_cast<float>(hither);
  scene.has_camera = true;
}

void add_light(Scene& scene, double x, double y, double z) {
  Light light;
  light.position = glm::vec3(glm::dvec3(x, y, z));
  scene.lights.push_back(light);
}

/// SPD gives the highlight as the angle where it has fallen to one half: cos(angle)^shine = 1/2. No angle stands for
/// 100000.
std::uint32_t add_surface(Scene& scene, const glm::dvec3& color, double diffuse, double specular,
                          double half_angle_degrees, double transmittance, double index) {
  Material material;
  material.color = glm::vec3(color);
  material.diffuse = static_cast<float>(diffuse);
  material.specular = static_cast<float>(specular);
  material.shine = half_angle_degrees == 0.0
                       ? 100000.0f
                       : static_cast<float>(std::log(0.5) / std::log(std::cos(half_angle_degrees * kPi / 180.0)));
  material.transmittance = static_cast<float>(transmittance);
  material.refraction_index = static_cast<float>(index);
  return add_material(scene, material);
}

void add_flat(Scene& scene, const std::vector<glm::dvec3>& corners, std::uint32_t material) {
  std::vector<glm::vec3> rounded;
  for (const glm::dvec3& corner : corners) rounded.push_back(glm::vec3(corner));
  PLUMBLINE_ASSERT(add_polygon(scene, rounded, {}, material) == Added::whole);
}

glm::dvec3 turned_z(const glm::dvec3& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}
glm::dvec3 turned_x(const glm::dvec3& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
}

// --- Sphereflake -----------------------------------------------------------------------------------------------------

/// A sphere of radius r has nine of r/3 upon it: six around its equator, 15 degrees off the x axis, and three at a
/// height of 2/sqrt(6), which is where they touch two of the six.
std::array<glm::dvec3, 9> flake_directions() {
  std::array<glm::dvec3, 9> directions;
  const double height = 2.0 / std::sqrt(6.0), radius = 1.0 / std::sqrt(3.0);
  for (std::size_t set = 0; set < 3; ++set) {
    const double turn = 2.0 * kPi * static_cast<double>(set) / 3.0;
    directions[3 * set] = turned_z({radius * std::cos(kPi / 4.0), radius * std::sin(kPi / 4.0), height}, turn);
    directions[3 * set + 1] = turned_z({std::cos(kPi / 12.0), std::sin(kPi / 12.0), 0.0}, turn);
    directions[3 * set + 2] = turned_z({std::cos(5.0 * kPi / 12.0), std::sin(5.0 * kPi / 12.0), 0.0}, turn);
  }
  return directions;
}

/// The shortest rotation that takes +z to `to`, applied to v (Rodrigues, with w = z x to).
glm::dvec3 turned_from_z(const glm::dvec3& v, const glm::dvec3& to) {
  // Straight down every axis is as short: SPD takes y. Directions are sums of few products of numbers up to 1, so
  // "straight" means within some units of 2^-53; all others are far from it.
  if (1.0 + to.z < 0x1p-40) return {-v.x, v.y, -v.z};
  const glm::dvec3 w(-to.y, to.x, 0.0), turned = glm::cross(w, v);
  return v + turned + glm::cross(w, turned) / (1.0 + to.z);
}

void grow_flake(Scene& scene, const std::array<glm::dvec3, 9>& directions, int depth, const glm::dvec3& center,
                double radius, const glm::dvec3& direction, std::uint32_t material) {
  add_sphere(scene, glm::vec3(center), static_cast<float>(radius), material);
  if (depth == 0) return;
  const double child_radius = radius / 3.0;
  for (const glm::dvec3& local : directions) {
    const glm::dvec3 child = turned_from_z(local, direction);
    grow_flake(scene, directions, depth - 1, center + (radius + child_radius) * child, child_radius, child, material);
  }
}

// --- Mountain --------------------------------------------------------------------------------------------------------

/// The generator of Numerical Recipes' first edition (m = 134456, a = 8121, c = 28411) and its Box-Muller, started anew
/// for each number: what SPD publishes as its portable Gaussian.
double spd_gauss(long seed) {
  constexpr long kModulus = 134456, kFactor = 8121, kIncrement = 28411;
  double first = 0.0, squared = 1.0;
  for (long state = seed; squared >= 1.0;) {
    const long next = (kIncrement + state * kFactor) % kModulus;
    state = (kIncrement + next * kFactor) % kModulus;
    first = 2.0 * static_cast<double>(next) / kModulus - 1.0;
    const double second = 2.0 * static_cast<double>(state) / kModulus - 1.0;
    squared = first * first + second * second;
  }
  return first * std::sqrt(-2.0 * std::log(squared) / squared);
}

struct Mountain {
  Scene& scene;
  int size;
  double points;  // cells along a side
  double roughness;
  std::uint32_t material;

  /// SPD's hash of a grid point to 16 bits. It repeats, and is kept: the published scene has the repetition in it.
  double noise(int x, int y) const {
    const auto a = static_cast<std::uint64_t>(x), b = static_cast<std::uint64_t>(y);
    const std::uint64_t hash = ((a << (23 - size)) + (b << (15 - size)) + (a << (7 - size))) & 0xffffu;
    constexpr long kMountainNumber = 21;
    return spd_gauss(kMountainNumber + static_cast<long>(hash));
  }

  /// The square of `width` cells at (x, y) whose corners have the heights lower left, lower right, upper right, upper
  /// left.
  void grow(int width, int x, int y, double ll, double lr, double ur, double ul) {
    if (width == 1) {
      const double left = -1.0 + x * 2.0 / points, right = -1.0 + (x + 1) * 2.0 / points;
      const double low = -1.0 + y * 2.0 / points, high = -1.0 + (y + 1) * 2.0 / points;
      add_flat(scene, {{left, low, ll}, {right, low, lr}, {right, high, ur}}, material);
      add_flat(scene, {{right, high, ur}, {left, high, ul}, {left, low, ll}}, material);
      return;
    }
    const int half = width / 2;
    const double rise = half * 2.0 / points * roughness;
    const double lower = (ll + lr) / 2.0 + rise * noise(x + half, y);
    const double right = (lr + ur) / 2.0 + rise * noise(x + width, y + half);
    const double upper = (ur + ul) / 2.0 + rise * noise(x + half, y + width);
    const double left = (ul + ll) / 2.0 + rise * noise(x, y + half);
    const double middle = (ll + lr + ur + ul) / 4.0 + 1.4142136 * rise * noise(x + half, y + half);
    grow(half, x, y, ll, lower, middle, left);
    grow(half, x + half, y, lower, lr, right, middle);
    grow(half, x + half, y + half, middle, right, ur, upper);
    grow(half, x, y + half, left, middle, upper, ul);
  }
};

// --- Tetrahedra ------------------------------------------------------------------------------------------------------

/// Corners of a cube around `center` that form a tetrahedron: those whose signs multiply to +1.
std::array<glm::dvec3, 4> tetra_points(const glm::dvec3& center, double half) {
  return {center + half * glm::dvec3(-1, -1, 1), center + half * glm::dvec3(-1, 1, -1),
          center + half * glm::dvec3(1, -1, -1), center + half * glm::dvec3(1, 1, 1)};
}

void grow_tetra(Scene& scene, int depth, const glm::dvec3& center, double half, std::uint32_t material) {
  if (depth > 1) {
    for (const glm::dvec3& child : tetra_points(center, half / 2.0))
      grow_tetra(scene, depth - 1, child, half / 2.0, material);
    return;
  }
  const auto p = tetra_points(center, half);
  add_flat(scene, {p[0], p[1], p[2]}, material);
  add_flat(scene, {p[3], p[2], p[1]}, material);
  add_flat(scene, {p[2], p[3], p[0]}, material);
  add_flat(scene, {p[1], p[0], p[3]}, material);
}

// --- Rings -----------------------------------------------------------------------------------------------------------

/// Six pentagons that link the midpoints of a dodecahedron's edges, scaled so that pipes of radius `pipe` along them
/// fit into a ball of radius 1.
std::array<glm::dvec3, 30> ring_points(double pipe) {
  std::array<glm::dvec3, 30> points;
  const double tilt = 2.0 * std::acos(std::cos(kPi / 3.0) / std::sin(kPi / 5.0));  // between neighbouring faces
  for (std::size_t i = 0; i < 5; ++i) {
    const double angle = 2.0 * kPi * static_cast<double>(i) / 5.0;
    points[i] = glm::dvec3(std::cos(angle), std::sin(angle), 0.0) / (1.0 + pipe);
    for (std::size_t ring = 1; ring < 6; ++ring) {
      points[5 * ring + i] = turned_z(turned_x(points[i], tilt), kPi * static_cast<double>(2 * ring - 1) / 5.0);
    }
  }
  return points;
}

// --- Gears -----------------------------------------------------------------------------------------------------------

constexpr int kTeeth = 36;

/// The outline of a gear in a plane z = const, four corners a tooth, turning by `sign`.
std::vector<glm::dvec3> gear_outline(const glm::dvec3& center, double angle, double outer, double inner, double sign) {
  std::vector<glm::dvec3> outline;
  const double tooth = 2.0 * kPi / kTeeth;
  for (int i = 0; i < kTeeth; ++i) {
    const double at = angle + sign * 2.0 * kPi * i / kTeeth;
    outline.push_back(center + turned_z({outer, 0.0, 0.0}, at - sign * 0.19 * tooth));
    outline.push_back(center + turned_z({outer, 0.0, 0.0}, at + sign * 0.19 * tooth));
    outline.push_back(center + turned_z({inner, 0.0, 0.0}, at + sign * 0.3 * tooth));
    outline.push_back(center + turned_z({inner, 0.0, 0.0}, at + sign * 0.7 * tooth));
  }
  return outline;
}

void add_gear(Scene& scene, const glm::dvec3& center, double angle, double outer, double inner, double thickness,
              std::uint32_t material) {
  const std::vector<glm::dvec3> top = gear_outline(center, angle, outer, inner, 1.0);
  add_flat(scene, top, material);
  const glm::dvec3 down(0.0, 0.0, -thickness);
  for (std::size_t i = 0; i < top.size(); ++i) {
    const glm::dvec3 &a = top[i], &b = top[(i + 1) % top.size()];
    add_flat(scene, {a, a + down, b + down, b}, material);
  }
  add_flat(scene, gear_outline(center + down, angle, outer, inner, -1.0), material);
}

double fraction(double x) { return x - std::floor(x); }

}  // namespace

Scene make_sphereflake(int size) {
  Scene scene;
  set_view(scene, {2.1, 1.3, 1.7}, {0, 0, 0}, {0, 0, 1}, 0.01);
  add_light(scene, 4, 3, 2);
  add_light(scene, 1, -4, 4);
  add_light(scene, -3, 1, 5);
  const std::uint32_t floor = add_surface(scene, {1.0, 0.75, 0.33}, 0.8, 0.0, 0.0, 0.0, 1.0);
  add_flat(scene, {{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}}, floor);
  const std::uint32_t mirror = add_surface(scene, {1.0, 0.9, 0.7}, 0.5, 0.5, 37.0, 0.0, 1.0);
  grow_flake(scene, flake_directions(), size, {0, 0, 0}, 0.5, {0, 0, 1}, mirror);
  return scene;
}

Scene make_mount(int size) {
  Scene scene;
  set_view(scene, {-1.6, 1.6, 1.7}, {0, 0, 0}, {0, 0, 1}, 0.01);
  add_light(scene, -100, -100, 100);
  const std::uint32_t glass = add_surface(scene, {1, 1, 1}, 0.1, 0.1, 6.7, 0.9, 1.5);
  // Four spheres that touch: the corners of a regular tetrahedron at sqrt(3/2) radii from its centre, one above.
  constexpr double kRadius = 0.17;
  const glm::dvec3 center(-0.8, 0.8, 1.0);
  const double distance = kRadius * std::sqrt(1.5);
  add_sphere(scene, glm::vec3(center + glm::dvec3(0, 0, distance)), kRadius, glass);
  const double across = distance * std::sqrt(8.0) / 3.0;  // at height -1/3
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 lower(across / std::sqrt(2.0), -across / std::sqrt(2.0), -distance / 3.0);
    add_sphere(scene, glm::vec3(center + turned_z(lower, 2.0 * kPi * i / 3.0)), kRadius, glass);
  }
  const std::uint32_t rock = add_surface(scene, {0.5, 0.45, 0.35}, 1.0, 0.0, 0.0, 0.0, 0.0);
  constexpr double kFractalDimension = 2.2;
  const double ratio = 2.0 / std::exp2(1.0 / (kFractalDimension - 1.0));
  const int cells = 1 << size;
  Mountain{scene, size, static_cast<double>(cells), std::sqrt(ratio * ratio - 1.0), rock}.grow(cells, 0, 0, 0, 0, 0, 0);
  return scene;
}

Scene make_tetra(int size) {
  Scene scene;
  set_view(scene, {1.022846, -3.177154, -2.174512}, {-0.004103, -0.004103, 0.216539}, {-0.816497, -0.816497, 0.816497},
           1.0);
  add_light(scene, 2, -18, -5);
  grow_tetra(scene, size, {0, 0, 0}, 1.0, add_surface(scene, {1.0, 0.2, 0.2}, 1.0, 0.0, 0.0, 0.0, 0.0));
  return scene;
}

Scene make_rings(int size) {
  Scene scene;
  constexpr double kPipe = 0.07412;
  const double spread = 1.0 / std::sin(kPi / 8.0);
  const glm::dvec3 from(-1.0, -spread, 0.5);
  set_view(scene, from, from + glm::dvec3(0, 1, 0), {0, 0, 1}, 1.0);
  add_light(scene, 3, -spread, 3);
  add_light(scene, -4, -spread, 1);
  add_light(scene, 2, -spread, -4);
  const std::uint32_t white = add_surface(scene, {1, 1, 1}, 1.0, 0.0, 0.0, 0.0, 0.0);
  const double depth = spread * (size + 1),
               reach = 1.01 * (depth - from.y) * std::tan(kPi / 8.0);  // the view and 1 % more
  add_flat(scene,
           {{from.x + reach, depth, from.z + reach},
            {from.x - reach, depth, from.z + reach},
            {from.x - reach, depth, from.z - reach},
            {from.x + reach, depth, from.z - reach}},
           white);
  constexpr std::array<std::array<double, 3>, 6> kColors = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}}};
  std::array<std::uint32_t, 6> material{};
  for (std::size_t i = 0; i < 6; ++i) {
    material[i] = add_surface(scene, {kColors[i][0], kColors[i][1], kColors[i][2]}, 0.5, 0.2, 37.0, 0.0, 0.0);
  }
  const auto points = ring_points(kPipe);
  for (int layer = 0; layer < size; ++layer) {
    for (int row = 0; row <= layer; ++row) {
      for (int column = 0; column <= layer; ++column) {
        const glm::dvec3 offset(2 * column - layer, spread * (layer + 1), 2 * row - layer);
        for (std::size_t i = 0; i < 30; ++i) {
          const std::size_t previous = i % 5 == 0 ? i + 4 : i - 1;
          const glm::vec3 base(points[i] + offset), apex(points[previous] + offset);
          PLUMBLINE_ASSERT(add_cone(scene, base, kPipe, apex, kPipe, material[i / 5]) == Added::whole);
          add_sphere(scene, base, kPipe, material[i / 5]);
        }
      }
    }
  }
  return scene;
}

Scene make_gears(int size) {
  Scene scene;
  set_view(scene, {-1.1, -2.1, 2.6}, {0, 0, 0}, {0, 0, 1}, 1.0);
  add_light(scene, 2, 4, 4);
  add_light(scene, -2, 4, 3);
  add_light(scene, 2, -2.5, 2.5);
  add_light(scene, -1, -4, 2);
  add_light(scene, -1.111, -2.121, 2.626);
  add_flat(scene, {{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}},
           add_surface(scene, {1.0, 0.85, 0.7}, 0.3, 0.6, 37.0, 0.0, 0.0));
  constexpr double kOuter = 0.995, kInner = 0.9;  // of the radius at which neighbours would touch
  const double radius = 1.0 / (size - (size - 1) * (1.0 - kInner) / 2.0);
  const double step = radius * (1.0 + kInner), thickness = std::min(0.1, 1.0 / (2.0 * size));
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        glm::dvec3 color(0.01 + fraction((x * 3 + y * 2 + z + 1) * 5.0 / 7.0),
                         0.01 + fraction((y * 3 + z * 2 + x + 1) * 3.0 / 7.0),
                         0.01 + fraction((z * 3 + x * 2 + y + 1) * 2.0 / 7.0));
        color /= std::max({color.x, color.y, color.z});
        const bool is_glass = (x * 4 + y * 2 + z) % 5 == 0;
        const std::uint32_t material = is_glass ? add_surface(scene, color, 0.2, 0.0, 0.0, 0.8, 1.1)
                                                : add_surface(scene, color, 1.0, 0.0, 0.0, 0.0, 0.0);
        const glm::dvec3 center(-1.0 + radius + x * step, -1.0 + radius + y * step,
                                1.0 - static_cast<double>(z) / size);
        const double angle = kPi * ((x + y + z) % 2) / kTeeth;
        add_gear(scene, center, angle, kOuter * radius, kInner * radius, thickness, material);
      }
    }
  }
  return scene;
}

}  // namespace plumbline
