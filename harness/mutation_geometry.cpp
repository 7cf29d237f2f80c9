// SPDX-License-Identifier: GPL-3.0-or-later
// Exact scaling, and the triangle test alone: asked with numbers that no scene brings together, and judged in C++.
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "harness/mutation_oracles.h"
#include "scenes/random.h"
#include "tracer/pass.h"
#include "tracer/shader_words.h"
#include "tracer/small_pass.h"

namespace plumbline {
namespace {

constexpr std::uint64_t kSeed = name_hash("mutants of geometry");

/// x * 2^e for all x and e, against std::ldexp.
MutationOracle scaling(GlContext& context) {
  constexpr int kSide = 64;
  InputTexels input{kSide, kSide, {}};
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    Random random(kSeed, 1, i);
    auto bits = static_cast<std::uint32_t>(random.bits());
    if (i % 4 == 0) bits &= 0x807fffffu;                        // a denormal
    if (i % 64 == 1) bits &= 0x80000000u;                       // a zero
    if (i % 64 == 2) bits |= 0x7f800000u, bits &= 0xff800000u;  // an infinity
    if (i % 64 > 2 && (bits & 0x7f800000u) == 0x7f800000u) bits &= 0xbfffffffu;
    const int exponent = static_cast<int>(bits >> 23 & 255u);
    // Half of the results lie around the smallest normal number.
    const int e =
        i % 2 == 0 ? static_cast<int>(random.below(601)) - 300 : 1 - exponent + static_cast<int>(random.below(8)) - 6;
    if ((bits & 0x7f800000u) == 0x7f800000u && (bits & 0x7fffffu) != 0) bits = 0;
    input.texels.emplace_back(std::bit_cast<float>(bits), static_cast<float>(e), 0.0f, 0.0f);
  }
  const std::array<std::string_view, 3> files{"pass_constants.glsl", "exact.glsl", "ask_scaling.frag.glsl"};
  const std::array<ShaderDefine, 1> defines{ShaderDefine{"PASS_CONSTANT", "flat in"}};
  const ShaderText shader = compose_shader(files, defines);
  MutationOracle oracle;
  oracle.name = "exact.scaling";
  oracle.programs.push_back(active_lines(shader));
  oracle.ask = [&context, shader, input](const Mutant&) -> std::string {
    const auto got = run_small_pass(context, {shader, kSide, kSide}, input);
    for (std::size_t i = 0; i < got.size(); ++i) {
      const float x = input.texels[i].x, exact = std::ldexp(x, static_cast<int>(input.texels[i].y));
      const float scaled = std::bit_cast<float>(got[i][0]);
      const bool is_right = std::abs(exact) < 0x1p-126f ? std::abs(scaled) <= std::abs(exact) : scaled == exact;
      if (!is_right) return "number " + std::to_string(i) + " is scaled to " + std::to_string(scaled);
      // Below the smallest normal number the bits count steps of 2^-149; a half may go either way.
      const double steps =
          std::ldexp(std::abs(static_cast<double>(input.texels[i].x)), static_cast<int>(input.texels[i].y) + 149);
      const bool has_right_bits = std::abs(exact) < 0x1p-126f
                                      ? std::abs(got[i][1] - steps) <= 0.5
                                      : got[i][1] == std::bit_cast<std::uint32_t>(std::abs(exact));
      if (std::isfinite(x) && !has_right_bits) return "the bits of number " + std::to_string(i) + " are others, scaled";
    }
    return {};
  };
  return oracle;
}

struct AskedTriangle {
  glm::vec3 origin, direction;
  std::array<glm::vec3, 3> corners;
  bool has_size = true;         ///< near 1: what a ray sees of it is judged, not its normal alone
  bool through_corner = false;  ///< the ray passes through corner 0, in exact numbers
};

/// Near the origin: slivers, specks and ordinary ones, at any angle to the ray, and what the cases below say.
std::vector<AskedTriangle> asked_triangles(std::size_t count) {
  std::vector<AskedTriangle> all;
  for (std::size_t i = 0; i < count; ++i) {
    Random random(kSeed, 2, i);
    const auto point = [&](double side) {
      const double x = random.uniform(-side, side), y = random.uniform(-side, side), z = random.uniform(-side, side);
      return glm::vec3(x, y, z);
    };
    AskedTriangle t{point(4.0), glm::vec3(random.direction()), {}};
    const auto size = static_cast<float>(std::exp2(random.uniform(-24.0, 2.0)));
    const glm::vec3 at = point(1.0), along = point(1.0);
    const float thin = static_cast<float>(std::exp2(random.uniform(-20.0, 0.0)));
    t.corners = {at, at + size * along, at + size * (0.5f * along + thin * point(1.0))};
    if (i % 2 == 0) {  // seen nearly edge-on, along an axis where i % 4 is 0
      if (i % 4 == 0)
        t.direction = glm::vec3(0.0f), t.direction[static_cast<int>(i / 4 % 3)] = i % 8 == 0 ? 1.0f : -1.0f;
      const glm::vec3 side = point(1.0);
      t.corners[2] = t.corners[0] + size * (t.direction + thin * side);
      t.corners[1] = t.corners[0] + size * (0.3f * t.direction + 0.2f * thin * point(1.0));
    }
    // Towards a point of the triangle.
    const glm::vec3 target = 0.3f * t.corners[0] + 0.3f * t.corners[1] + 0.4f * t.corners[2];
    t.origin = target - 3.0f * t.direction;
    const auto axis = static_cast<int>(i / 8 % 3), next = (axis + 1) % 3, last = (axis + 2) % 3;
    const std::size_t far = i / 8 % 9 / 3;
    switch (i % 8) {
      case 1:  // of any size; normals alone
        t.has_size = false;
        for (glm::vec3& c : t.corners) c *= std::exp2(i % 16 == 1 ? 60.0f : -60.0f);
        if (i % 64 == 1) t.corners = {glm::vec3(-0x1p126f), glm::vec3(0x1p126f, 0x1p120f, 0.0f), glm::vec3(0x1p126f)};
        break;
      case 3: {  // one corner far from the ray, along an axis, and the others near it
        t.direction = glm::vec3(0.0f), t.direction[axis] = i % 16 == 3 ? 1.0f : -1.0f;
        t.origin = -3.0f * t.direction;
        const int aside = i % 32 < 16 ? next : last;
        t.corners = {glm::vec3(0.0f), glm::vec3(0.0f), glm::vec3(0.0f)};
        for (std::size_t k = 0; k < 3; ++k) t.corners[k][aside] = k == far ? 1.0f : -0x1p-7f;
        t.corners[(far + 1) % 3][next + last - aside] = static_cast<float>(std::exp2(random.uniform(-12.0, -8.5)));
        break;
      }
      case 5: {  // lines, points, and what is a line but for the last place
        glm::vec3 line(0.0f);
        if (i % 32 != 5) line[axis] = 1.0f;
        t.corners = {glm::vec3(0.0f), line, 2.0f * line};
        if (i % 32 == 13) t.corners[1] = glm::vec3(1.0f, 2.0f, 3.0f), t.corners[2] = glm::vec3(2.0f, 4.0f, 6.0f);
        if (i % 32 == 21) {
          t.corners[1] = t.corners[2] = glm::vec3(0.0f);
          t.corners[1][next] = 1.0f + 0x1p-23f, t.corners[2][last] = 1.0f - 0x1p-23f;
          t.corners[1][last] = t.corners[2][next] = 1.0f;
        }
        break;
      }
      case 7:  // along an axis through a corner, and seen edge-on
        t.through_corner = true;
        t.direction = glm::vec3(0.0f), t.direction[axis] = 1.0f;
        t.corners[0] = glm::round(8.0f * t.corners[0]) / 8.0f;
        t.corners[1] = t.corners[0] + t.direction, t.corners[2] = t.corners[0] - 0.5f * t.direction;
        t.corners[1][next] += (i % 16 == 7 ? 0.5f : -0.5f), t.corners[2][next] += 0.25f;
        t.corners[2][last] += (i % 32 < 16 ? 0x1p-11f : -0x1p-11f);
        std::swap(t.corners[0], t.corners[far]);
        t.origin = t.corners[far] - 2.0f * t.direction;
        break;
      default:
        break;
    }
    all.push_back(t);
  }
  return all;
}

/// The corners as project() sees them, and what follows, in double from the ray as it walks.
struct Projection {
  double det = 0.0, far2 = 0.0, error = 0.0;  ///< error: of det in floats, at most, and of each edge function
  bool is_outside = false;                    ///< two edge functions contradict each other by more than that
};
Projection projected(const AskedTriangle& t) {
  const glm::dvec3 d(t.direction), size = glm::abs(d);
  const int z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2), x = (z + 1) % 3,
            y = (z + 2) % 3;
  std::array<glm::dvec2, 3> p;
  Projection result;
  double apart = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 c = glm::dvec3(t.corners[i]) - glm::dvec3(t.origin);
    p[i] = {c[x] - d[x] / d[z] * c[z], c[y] - d[y] / d[z] * c[z]};
    result.far2 = std::max(result.far2, glm::dot(p[i], p[i]));
    apart = std::max({apart, std::abs(c[x]), std::abs(c[y]), std::abs(c[z])});
  }
  const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
  result.det = cross(p[1] - p[0], p[2] - p[0]);
  // A projected corner is off by 8 u of its coordinates; six products of two such, and their sums.
  const double far = std::sqrt(result.far2), off = 8.0 * 0x1p-24 * apart;
  result.error = 6.0 * (2.0 * far * off + off * off) + 12.0 * 0x1p-24 * result.far2;
  const double u = cross(p[2], p[1]), v = cross(p[0], p[2]), w = cross(p[1], p[0]);
  result.is_outside = std::min({u, v, w}) < -result.error && std::max({u, v, w}) > result.error;
  return result;
}

/// Which triangles are told to be seen edge-on, by the share that shader_words.h states; and normals, also of lines.
MutationOracle triangles(GlContext& context) {
  constexpr int kCount = 4096;
  const std::vector<AskedTriangle> asked = asked_triangles(kCount);
  InputTexels input{5, kCount, {}};
  for (const AskedTriangle& t : asked)
    for (const glm::vec3& v : {t.origin, t.direction, t.corners[0], t.corners[1], t.corners[2]})
      input.texels.emplace_back(v, 0.0f);
  const std::array<std::string_view, 5> files{"pass_constants.glsl", "exact.glsl", "ray_prepare.glsl", "triangle.glsl",
                                              "ask_triangle.frag.glsl"};
  const auto number = [](double x) { return std::to_string(std::bit_cast<std::uint32_t>(static_cast<float>(x))); };
  const std::vector<ShaderDefine> defines{
      {"PASS_CONSTANT", "flat in"},
      {"SHIFT_EXPONENT", std::to_string(kShiftExponent)},
      {"SHIFT_UNIT", "uintBitsToFloat(" + number(1.0 / (1 << kShiftExponent)) + "u)"},
      {"EDGE_ON", "uintBitsToFloat(" + number(kEdgeOn) + "u)"},
      {"LEAST_DET", "uintBitsToFloat(" + number(kLeastDet) + "u)"}};
  const ShaderText shader = compose_shader(files, defines);
  MutationOracle oracle;
  oracle.name = "triangle.asked";
  ActiveLines lines = active_lines(shader);
  oracle.programs.push_back({{"triangle.glsl", lines.at("triangle.glsl")}, {"exact.glsl", lines.at("exact.glsl")}});
  oracle.ask = [&context, shader, input, asked](const Mutant&) -> std::string {
    const auto set = [](const GlProgram& program) {
      PassConstants constants;
      constants.ball = {0.0f, 0.0f, 0.0f, 8.0f};
      constants.factor = {1.0f, 1.0f, 1.0f, 0.0f};
      set_pass(program, constants, {});
    };
    const auto got = run_small_pass(context, {shader, 1, kCount, false, set}, input);
    for (std::size_t i = 0; i < got.size(); ++i) {
      const AskedTriangle& t = asked[i];
      const std::string name = "triangle " + std::to_string(i);
      const bool edge_on = (got[i][0] & 2u) != 0;
      const Projection p = projected(t);
      const double limit = std::max(kEdgeOn * p.far2, kLeastDet), margin = p.error + kEdgeOn * p.error;
      const bool inside = (got[i][0] & 1u) != 0, resolved = (got[i][0] & 4u) != 0;
      if (t.has_size && p.is_outside && (inside || resolved)) return name + " is not met by its ray";
      if (t.through_corner && !(inside && resolved)) return name + " is met in a corner";
      if (t.has_size && std::abs(p.det) + margin < limit && !edge_on) return name + " is seen edge-on";
      if (t.has_size && std::abs(p.det) - margin > limit && edge_on) return name + " is not seen edge-on";
      const glm::dvec3 e = glm::dvec3(t.corners[1] - t.corners[0]), f = glm::dvec3(t.corners[2] - t.corners[0]);
      const glm::dvec3 cross = glm::cross(e, f);  // exact but for the last places, of floats
      const glm::dvec3 normal(std::bit_cast<float>(got[i][1]), std::bit_cast<float>(got[i][2]),
                              std::bit_cast<float>(got[i][3]));
      constexpr double kBound = 16.0 * 0x1p-24;
      if (!(std::abs(glm::length(normal) - 1.0) <= kBound)) return name + " has a normal of another length than 1";
      if (!(std::abs(glm::dot(normal, e)) <= kBound * glm::length(e)))
        return name + " has a normal that is not square to its first edge";
      // The edges are floats here as there, and the difference of products is off by a few units of itself.
      if (glm::length(cross) > 0x1p-48 * glm::length(e) * glm::length(f) &&
          !(glm::length(normal - glm::normalize(cross)) <= kBound))
        return name + " has another normal";
    }
    return {};
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> geometry_oracles(GlContext& context) {
  std::vector<MutationOracle> oracles;
  oracles.push_back(scaling(context));
  oracles.push_back(triangles(context));
  return oracles;
}

}  // namespace plumbline
