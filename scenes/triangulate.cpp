// SPDX-License-Identifier: MIT
#include "scenes/triangulate.h"

#include <GL/glu.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>

#include "scenes/error.h"

namespace plumbline {
namespace {

// One component of the cross product (b - a) x (c - a) is the sum of six products of two floats. Each product is exact
// in double; their sum is decided by Shewchuk's expansions (1997): partial sums without overlap, whose last non-zero
// one has the sign.
bool is_zero_sum(const std::array<double, 6>& terms) {
  std::array<double, 6> partial{};
  std::size_t count = 0;
  for (double term : terms) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double sum = term + partial[i], virtual_part = sum - term;
      const double error = (term - (sum - virtual_part)) + (partial[i] - virtual_part);
      if (error != 0.0) partial[kept++] = error;
      term = sum;
    }
    partial[kept++] = term;
    count = kept;
  }
  return std::all_of(partial.begin(), partial.begin() + count, [](double part) { return part == 0.0; });
}

/// The direction to look along: Newell's normal (twice the area vector), or where the signed areas cancel (a figure of
/// eight) the largest of the triangles that it sums. Zero where no three corners span an area.
glm::dvec3 mean_normal(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0.0), largest(0.0);
  double total = 0.0;
  const glm::dvec3 origin(corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const glm::dvec3 part = glm::cross(glm::dvec3(corners[i]) - origin, glm::dvec3(corners[i + 1]) - origin);
    normal += part;
    total += glm::length(part);
    if (glm::dot(part, part) > glm::dot(largest, largest)) largest = part;
  }
  // Each part errs by a few units of 2^-53 of itself, the sum by as many as it has terms, kMaxPolygonCorners = 2^14 at
  // most.
  return glm::length(normal) > 0x1p-36 * total ? normal : largest;
}

// --- The polygon as GLU wants it -----------------------------------------------------------------------------------

struct Job {
  Triangulation result;
  std::vector<std::uint32_t> indices;             // the corners of triangles, three by three
  std::deque<std::array<double, 3>> coordinates;  // GLU keeps pointers to them, so they must not move
  std::uint32_t corner_count = 0;
  bool failed = false;
};

// GLU hands back pointers; an index plus one travels in each, so that a null pointer still means "none".
// NOLINTNEXTLINE(performance-no-int-to-ptr): nothing is ever read through them.
void* to_pointer(std::uint32_t index) { return reinterpret_cast<void*>(static_cast<std::uintptr_t>(index) + 1); }
std::uint32_t to_index(void* pointer) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer) - 1);
}

void on_begin(GLenum, void*) {}
void on_end(void*) {}
// Being asked for edge flags makes GLU emit separate triangles instead of fans and strips.
void on_edge_flag(GLboolean, void*) {}
void on_vertex(void* vertex, void* job) { static_cast<Job*>(job)->indices.push_back(to_index(vertex)); }
void on_error(GLenum, void* job) { static_cast<Job*>(job)->failed = true; }
void on_combine(GLdouble at[3], void* sources[4], GLfloat weights[4], void** out, void* user) {
  Job& job = *static_cast<Job*>(user);
  // Corners that coincide are reported as crossings too: those stay the corner that they are.
  if (sources[1] == nullptr || weights[0] == 1.0f) {
    *out = sources[0];
    return;
  }
  BlendedCorner corner;
  corner.position = glm::vec3(static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2]));
  for (std::size_t i = 0; i < 4; ++i) {
    corner.source[i] = sources[i] != nullptr ? to_index(sources[i]) : to_index(sources[0]);
    corner.weight[i] = sources[i] != nullptr ? weights[i] : 0.0f;
  }
  *out = to_pointer(job.corner_count + static_cast<std::uint32_t>(job.result.blended.size()));
  job.result.blended.push_back(corner);
}

using AnyCallback = void (*)();

void tessellate(std::span<const glm::vec3> corners, const glm::dvec3& normal, Job& job) {
  const std::unique_ptr<GLUtesselator, void (*)(GLUtesselator*)> owner(gluNewTess(), gluDeleteTess);
  GLUtesselator* const tess = owner.get();
  if (tess == nullptr) throw EnvironmentError("GLU: out of memory");
  gluTessProperty(tess, GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_NONZERO);
  gluTessCallback(tess, GLU_TESS_BEGIN_DATA, reinterpret_cast<AnyCallback>(on_begin));
  gluTessCallback(tess, GLU_TESS_END_DATA, reinterpret_cast<AnyCallback>(on_end));
  gluTessCallback(tess, GLU_TESS_EDGE_FLAG_DATA, reinterpret_cast<AnyCallback>(on_edge_flag));
  gluTessCallback(tess, GLU_TESS_VERTEX_DATA, reinterpret_cast<AnyCallback>(on_vertex));
  gluTessCallback(tess, GLU_TESS_ERROR_DATA, reinterpret_cast<AnyCallback>(on_error));
  gluTessCallback(tess, GLU_TESS_COMBINE_DATA, reinterpret_cast<AnyCallback>(on_combine));
  gluTessNormal(tess, normal.x, normal.y, normal.z);
  gluTessBeginPolygon(tess, &job);
  gluTessBeginContour(tess);
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    job.coordinates.push_back({corners[i].x, corners[i].y, corners[i].z});
    gluTessVertex(tess, job.coordinates.back().data(), to_pointer(i));
  }
  gluTessEndContour(tess);
  gluTessEndPolygon(tess);
}

// --- What GLU would take too long for ------------------------------------------------------------------------------

// GLU's sweep takes quadratic time and more where edges cross or corners coincide; below this many corners that is at
// most a fraction of a second.
constexpr std::size_t kCrossingsAllowed = 512;

/// Whether edges that are not neighbours touch, as seen along the axis where `normal` is largest.
bool crosses_itself(std::span<const glm::vec3> corners, const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<glm::dvec2> points;
  for (const glm::vec3& corner : corners) points.emplace_back(corner[(drop + 1) % 3], corner[(drop + 2) % 3]);
  const auto side = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 a = points[i], b = points[(i + 1) % n];
    const glm::dvec2 lower = glm::min(a, b), upper = glm::max(a, b);
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      const glm::dvec2 c = points[j], d = points[(j + 1) % n];
      if (std::min(c.x, d.x) > upper.x || std::max(c.x, d.x) < lower.x || std::min(c.y, d.y) > upper.y ||
          std::max(c.y, d.y) < lower.y)
        continue;
      if (side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0) return true;
    }
  }
  return false;
}

/// Whether a quadrilateral is convex and flat enough that both of its diagonals lie in it.
bool is_convex_quad(std::span<const glm::vec3> corners, const glm::dvec3& normal) {
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3 at(corners[i]);
    const glm::dvec3 turn = glm::cross(glm::dvec3(corners[(i + 1) % 4]) - at, glm::dvec3(corners[(i + 3) % 4]) - at);
    if (!(glm::dot(turn, normal) > 0.0)) return false;
  }
  return true;
}

}  // namespace

bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double ax = a[i], ay = a[j], bx = b[i], by = b[j], cx = c[i], cy = c[j];
    if (!is_zero_sum({bx * cy, -bx * ay, -ax * cy, -by * cx, by * ax, ay * cx})) return true;
  }
  return false;
}

Triangulation triangulate(std::span<const glm::vec3> corners) {
  const auto keep_area = [](Triangulation result, std::span<const glm::vec3> points) {
    const auto at = [&](std::uint32_t i) {
      return i < points.size() ? points[i] : result.blended[i - points.size()].position;
    };
    std::erase_if(result.triangles, [&](const auto& t) { return !has_area(at(t[0]), at(t[1]), at(t[2])); });
    return result;
  };
  Triangulation result;
  if (corners.size() < 3) return result;
  if (corners.size() == 3) {
    result.triangles.push_back({0, 1, 2});
    return keep_area(std::move(result), corners);
  }
  if (corners.size() > kMaxPolygonCorners) {
    result.too_complex = true;
    return result;
  }
  const glm::dvec3 normal = mean_normal(corners);
  if (normal == glm::dvec3(0.0)) return result;
  if (corners.size() == 4 && is_convex_quad(corners, normal)) {
    result.triangles = {{0, 1, 2}, {0, 2, 3}};
    return keep_area(std::move(result), corners);
  }
  if (corners.size() > kCrossingsAllowed && crosses_itself(corners, normal)) {
    result.too_complex = true;
    return result;
  }
  Job job;
  job.corner_count = static_cast<std::uint32_t>(corners.size());
  tessellate(corners, normal, job);
  if (job.failed) {
    result.too_complex = true;
    return result;
  }
  for (std::size_t i = 0; i + 2 < job.indices.size(); i += 3) {
    job.result.triangles.push_back({job.indices[i], job.indices[i + 1], job.indices[i + 2]});
  }
  return keep_area(std::move(job.result), corners);
}

}  // namespace plumbline
