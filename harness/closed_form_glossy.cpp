// SPDX-License-Identifier: GPL-3.0-or-later
// Glossy reflection: the lobe of a perturbed normal and the share of it that reflects beyond a step (closed_forms.md,
// section 3).
#include "harness/closed_forms.h"
#include "harness/quadrature.h"

namespace plumbline {
namespace {

using glm::dvec3;

constexpr double kTolerance = 1e-9;  ///< of a share

/// A curve of normals m and how a quadratic form varies along it.
struct Along {
  std::function<dvec3(double)> at, derivative;
};

/// For a normal m of any length the reflected direction is, but for its length, r = |m|^2 d - 2 (d.m) m. v.r along a
/// curve of normals, and its derivative.
struct Form {
  dvec3 d, v;
  double value(const dvec3& m) const { return glm::dot(m, m) * glm::dot(v, d) - 2.0 * glm::dot(d, m) * glm::dot(v, m); }
  double change(const dvec3& m, const dvec3& dm) const {
    return 2.0 * glm::dot(m, dm) * glm::dot(v, d) -
           2.0 * (glm::dot(d, dm) * glm::dot(v, m) + glm::dot(d, m) * glm::dot(v, dm));
  }
};

/// All zeros of a form along a curve within [from, to], given a bound on its second derivative there. Rigorous: a part
/// without change of sign is left only where the bound forbids a zero, one with it only where the form is monotone.
void zeros(const Form& form, const Along& curve, double bound, double from, double to, std::vector<double>& found) {
  const auto value = [&](double s) { return form.value(curve.at(s)); };
  const double a = value(from), b = value(to), width = to - from, middle = 0.5 * (from + to);
  const bool changes = (a < 0.0) != (b < 0.0);
  if (!changes && std::min(std::fabs(a), std::fabs(b)) > bound * width * width / 8.0) return;
  if (width < 1e-9) {
    if (changes) found.push_back(middle);
    return;
  }
  if (changes && std::fabs(form.change(curve.at(middle), curve.derivative(middle))) > 0.5 * bound * width) {
    double low = from, high = to;
    for (int i = 0; i < 60 && low < high; ++i) {
      const double half = 0.5 * (low + high);
      ((value(half) < 0.0) == (a < 0.0) ? low : high) = half;
    }
    found.push_back(0.5 * (low + high));
    return;
  }
  zeros(form, curve, bound, from, middle, found);
  zeros(form, curve, bound, middle, to, found);
}

/// The length of the part of [from, to] where normals reflect d to u.r > 0, with r mirrored above z = 0.
double length_beyond(const dvec3& d, const dvec3& u, const Along& curve,
                     const std::function<double(const Form&)>& bound, double from, double to) {
  const Form up{d, {0, 0, 1}};
  std::vector<double> ends{from, to};
  for (const Form& form : {up, Form{d, u}, Form{d, {u.x, u.y, -u.z}}}) zeros(form, curve, bound(form), from, to, ends);
  std::sort(ends.begin(), ends.end());
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const dvec3 m = curve.at(0.5 * (ends[i] + ends[i + 1]));
    const double mirrored = up.value(m) < 0.0 ? -u.z : u.z;
    if (Form{d, {u.x, u.y, mirrored}}.value(m) > 0.0) sum += ends[i + 1] - ends[i];
  }
  return sum;
}

/// The ball of radius g around the normal z: the angle a to z has the density sin a sqrt(D) (3 cos^2 a + D) / g^3 with
/// D = g^2 - sin^2 a, all directions around it are alike.
double ball_share(double g, const dvec3& d, const dvec3& u) {
  const auto ring = [&](double a) {
    const double s = std::sin(a), c = std::cos(a), rest = g * g - s * s;
    if (!(rest > 0.0) || s == 0.0) return 0.0;
    const Along circle{[=](double f) { return dvec3(s * std::cos(f), s * std::sin(f), c); },
                       [=](double f) { return dvec3(-s * std::sin(f), s * std::cos(f), 0.0); }};
    const auto bound = [&](const Form& form) { return 4.0 * s * (1.0 + s) * glm::length(form.v) * glm::length(d); };
    const double share = length_beyond(d, u, circle, bound, 0.0, 2.0 * std::numbers::pi) / (2.0 * std::numbers::pi);
    return share * s * std::sqrt(rest) * (3.0 * c * c + rest) / (g * g * g);
  };
  return integrate_pieces(ring, 0.0, std::asin(g), {}, kTolerance);
}

/// The cube of half-side g around the normal z. Through (s, t, 1) it is seen from 0 along z from 1 - g to the least of
/// 1
/// + g and g / max(|s|, |t|), so the density of (s, t) depends on the square around 0 that it lies on.
double cube_share(double g, const dvec3& d, const dvec3& u) {
  const auto ring = [&](double half) {
    const double last = std::min(1.0 + g, g / half), first = 1.0 - g;
    const double density = (last * last * last - first * first * first) / (24.0 * g * g * g);
    double length = 0.0;
    for (const double side : {-half, half})
      for (const bool along_x : {false, true}) {
        const dvec3 step = along_x ? dvec3(1, 0, 0) : dvec3(0, 1, 0),
                    start = along_x ? dvec3(0, side, 1) : dvec3(side, 0, 1);
        const Along line{[=](double s) { return start + s * step; }, [=](double) { return step; }};
        const auto bound = [&](const Form& form) { return 2.0 * std::fabs(form.value(step)); };
        length += length_beyond(d, u, line, bound, -half, half);
      }
    return density * length;
  };
  return integrate_pieces(ring, 0.0, g / (1.0 - g), {g / (1.0 + g)}, kTolerance);
}

constexpr int kSide = 16;  ///< of the pictures, pixels

struct View {
  glm::vec3 from, at, up;
  double pixel;
};

/// A mirror at z = 0 and a black thing before a white background. `beyond` tells of a point of the mirror which
/// reflections (u.r > 0) meet the black thing.
ClosedForm step(Effects::Model model, const View& view, double glossy, const std::array<glm::vec3, 4>& black,
                const std::function<dvec3(const dvec3&)>& beyond, float mirror_end) {
  ClosedForm form;
  Scene& scene = form.scene;
  scene = scene_for(model, view.from, view.at, view.up, kSide, kSide, view.pixel);
  scene.effects.glossy_reflections = true;
  scene.effects.glossy = static_cast<float>(glossy);
  scene.materials.push_back({.name = "mirror", .diffuse = 0.0f, .specular = 1.0f});
  add_quad(scene, {glm::vec3{-4, -4, 0}, {mirror_end, -4, 0}, {mirror_end, 4, 0}, {-4, 4, 0}}, 0);
  add_quad(scene, black, add_black(scene));

  const dvec3 from(view.from), forward = glm::normalize(dvec3(view.at) - from);
  const dvec3 right = glm::normalize(glm::cross(forward, dvec3(view.up))), up = glm::cross(right, forward);
  // Seen from y and from -y the scene is the same.
  const double pitch = pixel_of(scene.camera), g = static_cast<double>(scene.effects.glossy);
  Profile& profile = form.profile;
  profile.width = profile.height = kSide;
  const double center = 0.5 * (kSide - 1);
  fill_pixels(
      profile, [](int column, int row) { return std::pair(column, std::min(row, kSide - 1 - row)); },
      [&](int column, int row) {
        const dvec3 d = forward + pitch * (column - center) * right + pitch * (center - row) * up;
        const dvec3 p = from - from.z / d.z * d;
        return SampleMoments::chance(1.0 - glossy_share(model, g, glm::normalize(d), beyond(p)));
      });
  for (int i = 0; i < kSide * kSide; ++i) profile.point_of.push_back(static_cast<std::uint32_t>(i % kSide));
  for (int column = 0; column < kSide; ++column) profile.place.push_back(column - center);
  return form;
}

/// From above: the lobe's two sides as one step sweeps over it.
ClosedForm from_above(Effects::Model model, double size) {
  constexpr float kEdge = 0.01f;
  // From the mirror at p the black half plane z = 1, x > edge is met where r.x > (edge - p.x) r.z.
  return step(
      model, {{0, 0, 0.5f}, {0, 0, 0}, {0, 1, 0}, 0.022}, 0.1 * size,
      {glm::vec3{kEdge, -50, 1}, {50, -50, 1}, {50, 50, 1}, {kEdge, 50, 1}},
      [](const dvec3& p) { return dvec3(1.0, 0.0, static_cast<double>(p.x) - static_cast<double>(kEdge)); }, 4.0f);
}

/// At a grazing angle: a good part of the lobe points below the mirror and is mirrored back above it.
ClosedForm grazing(Effects::Model model, double size) {
  constexpr float kLow = 0.3f, kWall = 2.5f;
  // A camera on its side, so that the profile runs along the columns. The wall x = 2.5 is black above z = 0.3.
  return step(
      model, {{-1.5f, 0, 0.3f}, {0, 0, 0}, {0, 1, 0}, 0.013}, 0.3 * size,
      {glm::vec3{kWall, -400, kLow}, {kWall, 400, kLow}, {kWall, 400, 400}, {kWall, -400, 400}},
      [](const dvec3& p) { return dvec3(-static_cast<double>(kLow) / (static_cast<double>(kWall) - p.x), 0.0, 1.0); },
      2.4f);
}

}  // namespace

double glossy_share(Effects::Model model, double glossy, const glm::dvec3& d, const glm::dvec3& u) {
  return model == Effects::Model::paper ? cube_share(glossy, d, u) : ball_share(glossy, d, u);
}

std::vector<ClosedFormInfo> glossy_forms() {
  std::vector<ClosedFormInfo> forms;
  for (const auto model : {Effects::Model::paper, Effects::Model::physical}) {
    const std::string body = model == Effects::Model::paper ? "cube" : "ball";
    forms.push_back({"glossy", "7.3", "step", model, "glossiness", "place across the reflected step (pixels)",
                     "A step is reflected with the lobe of a normal that is perturbed by a " + body + ".",
                     [model](double size) { return from_above(model, size); }});
    forms.push_back(
        {"glossy", "7.3", "grazing", model, "glossiness", "place along the mirror (pixels)",
         "At a grazing angle what the " + body + " reflects below the surface comes back mirrored above it.",
         [model](double size) { return grazing(model, size); }});
  }
  return forms;
}

}  // namespace plumbline
