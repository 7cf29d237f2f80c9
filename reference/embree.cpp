// SPDX-License-Identifier: GPL-3.0-or-later
// Embree as the finder of the nearest primitive; everything Embree's own stays in this file.
#include "reference/embree.h"

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "reference/hit_values.h"
#include "scenes/error.h"

namespace plumbline {

namespace {

constexpr unsigned kTriangleGeometry = 0, kSphereGeometry = 1;
/// Embree takes t = tnear for a hit, SEMANTICS leaves t = 0 out: the least t that is not flushed to zero.
constexpr float kNear = std::numeric_limits<float>::min();
constexpr std::size_t kBlock = 64;  ///< rays that one task converts, traces and evaluates at a time

struct Center {
  glm::dvec3 center;
  double radius;
};

/// What the sphere callback needs beside Embree's 32-bit ray. `base` comes first: Embree hands back a pointer to it.
struct Context {
  RTCIntersectContext base;
  const Line* line = nullptr;  ///< world space; null where the ray is to be taken as Embree has it (the benchmark)
  double best = 0.0;           ///< s of the sphere that is the nearest hit so far, where one is
};

/// What the callbacks read. Its address must not change.
struct Spheres {
  std::vector<Center> centers;  ///< world space
  double scale = 1.0;           ///< of Embree's space to world space
};

/// MXCSR with denormals flushed, as Embree asks for in each thread that traces; put back afterwards. Only around
/// Embree: our own arithmetic must see denormal floats.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

/// Puts MXCSR back when it goes: opening a device leaves denormals flushed in the calling thread, and threads that TBB
/// starts afterwards would inherit it.
class KeepFloatingPoint {
 public:
  KeepFloatingPoint() : saved_(_mm_getcsr()) {
    tbb::parallel_for(0, 64, [](int) {});  // TBB's arena takes the settings of the moment when it is first used: now
  }
  ~KeepFloatingPoint() { _mm_setcsr(saved_); }
  KeepFloatingPoint(const KeepFloatingPoint&) = delete;
  KeepFloatingPoint& operator=(const KeepFloatingPoint&) = delete;

 private:
  unsigned saved_;
};

float round_down(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -INFINITY) : f;
}
float round_up(double x) { return -round_down(-x); }

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& spheres = *static_cast<const Spheres*>(args->geometryUserPtr);
  const auto& [center, radius] = spheres.centers[args->primID];
  const glm::dvec3 lower = (center - radius) * spheres.scale, upper = (center + radius) * spheres.scale;
  RTCBounds& b = *args->bounds_o;
  b.lower_x = round_down(lower.x), b.lower_y = round_down(lower.y), b.lower_z = round_down(lower.z), b.align0 = 0.0f;
  b.upper_x = round_up(upper.x), b.upper_y = round_up(upper.y), b.upper_z = round_up(upper.z), b.align1 = 0.0f;
}

void intersect_sphere(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& spheres = *static_cast<const Spheres*>(args->geometryUserPtr);
  auto& context = *reinterpret_cast<Context*>(args->context);
  auto& ray_hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  RTCRay& ray = ray_hit.ray;
  const auto& [center, radius] = spheres.centers[args->primID];

  Line as_given;
  if (context.line == nullptr) {
    as_given.point = {ray.org_x, ray.org_y, ray.org_z};
    as_given.direction = {ray.dir_x, ray.dir_y, ray.dir_z};
  }
  const Line& line = context.line == nullptr ? as_given : *context.line;
  const SphereRoots roots = sphere_roots(line, center, radius);
  if (!roots.met) return;
  const double s = nearest_root(line, roots);
  if (!(line.shift + s > 0.0)) return;
  if (context.line != nullptr && !(line.shift + s <= line.t_max)) return;
  // Between spheres doubles decide; against triangles Embree's own t is all there is.
  const double s_embree = s * spheres.scale;
  if (context.line != nullptr && ray_hit.hit.geomID == kSphereGeometry) {
    if (!(s < context.best)) return;
  } else if (!(s_embree <= static_cast<double>(ray.tfar))) {
    return;
  }
  context.best = s;
  ray.tfar = std::min(ray.tfar, round_up(s_embree));
  ray_hit.hit.u = ray_hit.hit.v = 0.0f;
  ray_hit.hit.geomID = args->geomID;
  ray_hit.hit.primID = args->primID;
  ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

/// A power of two that brings the radius into [2^-20, 2^20]: Embree multiplies three coordinates in 32 bits. 1 for most
/// scenes.
double scale_for(double radius) {
  constexpr int kLimit = 20;
  if (!(radius > 0.0)) return 1.0;
  const int exponent = std::ilogb(radius);
  if (exponent > kLimit) return std::ldexp(1.0, kLimit - exponent);
  if (exponent < -kLimit) return std::ldexp(1.0, -kLimit - exponent);
  return 1.0;
}

void clear_hit(RTCRayHit& ray_hit) {
  ray_hit.hit.geomID = ray_hit.hit.primID = RTC_INVALID_GEOMETRY_ID;
  ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

}  // namespace

struct EmbreeScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Ball ball;
  double scale = 1.0;
  SphereMode mode = SphereMode::exact_user;
  std::vector<glm::vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Spheres spheres;

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  /// Throws where Embree has reported an error since the last call.
  void check() const {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw EnvironmentError("Embree ran out of memory while building its tree");
    if (error != RTC_ERROR_NONE) throw EnvironmentError("Embree failed with error " + std::to_string(error));
  }

  float* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t stride,
                    std::size_t count) const {
    void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
    if (buffer == nullptr) check();
    PLUMBLINE_ASSERT(buffer != nullptr);
    return static_cast<float*>(buffer);
  }

  void attach(RTCGeometry geometry, unsigned number) const {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, number);
    rtcReleaseGeometry(geometry);
  }

  void add_triangles() const {
    if (triangles.empty()) return;
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* vertices =
        new_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) vertices[3 * i + axis] = static_cast<float>(positions[i][axis] * scale);
    }
    float* indices =
        new_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, sizeof(triangles[0]), triangles.size());
    std::copy(triangles.begin(), triangles.end(), reinterpret_cast<std::array<std::uint32_t, 3>*>(indices));
    attach(geometry, kTriangleGeometry);
  }

  void add_spheres() {
    if (spheres.centers.empty()) return;
    if (mode == SphereMode::embree) {
      const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
      float* buffer =
          new_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), spheres.centers.size());
      for (const auto& [center, radius] : spheres.centers) {
        for (int axis = 0; axis < 3; ++axis) *buffer++ = static_cast<float>(center[axis] * scale);
        *buffer++ = static_cast<float>(radius * scale);
      }
      attach(geometry, kSphereGeometry);
      return;
    }
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(spheres.centers.size()));
    rtcSetGeometryUserData(geometry, &spheres);
    rtcSetGeometryBoundsFunction(geometry, sphere_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_sphere);
    attach(geometry, kSphereGeometry);
  }

  /// Fills Embree's ray. False where it cannot hit anything and Embree need not be asked.
  bool prepare(const Line& line, RTCRayHit& ray_hit) const {
    const double last = (line.t_max - line.shift) * scale;
    if (!(line.t_max > 0.0) || !(last > 0.0)) return false;  // the segment is empty, or ends before the scene
    if (line.shift < 0.0) return false;                      // the scene lies far behind the origin
    const glm::dvec3 origin = (line.point + line.rest) * scale;
    RTCRay& ray = ray_hit.ray;
    ray.org_x = static_cast<float>(origin.x), ray.org_y = static_cast<float>(origin.y),
    ray.org_z = static_cast<float>(origin.z);
    ray.dir_x = static_cast<float>(line.direction.x);
    ray.dir_y = static_cast<float>(line.direction.y);
    ray.dir_z = static_cast<float>(line.direction.z);
    ray.tnear = kNear;
    ray.tfar = static_cast<float>(last);
    ray.time = 0.0f;
    ray.mask = 0xffffffffu;
    ray.id = ray.flags = 0;
    clear_hit(ray_hit);
    return true;
  }

  ReferenceHit values(const Line& line, const RTCRayHit& ray_hit) const {
    const std::uint32_t number = ray_hit.hit.primID;
    if (ray_hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    if (ray_hit.hit.geomID == kTriangleGeometry) {
      const auto& p = triangles[number];
      ReferenceHit hit =
          triangle_values(line, {positions[p[0]], positions[p[1]], positions[p[2]]}, ray_hit.ray.tfar / scale);
      hit.primitive = number;
      return hit;
    }
    const auto& [center, radius] = spheres.centers[number];
    ReferenceHit hit = sphere_values(line, center, radius);
    hit.primitive = static_cast<std::uint32_t>(triangles.size()) + number;
    return hit;
  }

  void intersect_block(std::span<const Ray> rays, std::span<ReferenceHit> hits) const {
    std::array<Line, kBlock> lines;
    std::array<RTCRayHit, kBlock> ray_hits;
    std::array<bool, kBlock> asked;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      asked[i] = is_defined(rays[i]);
      if (asked[i]) lines[i] = line_near(rays[i], ball);
      if (asked[i]) asked[i] = prepare(lines[i], ray_hits[i]);
    }
    {
      const FlushDenormals flush;
      Context context;
      rtcInitIntersectContext(&context.base);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        context.line = &lines[i];
        if (asked[i]) rtcIntersect1(scene, &context.base, &ray_hits[i]);
      }
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      hits[i] = asked[i] ? values(lines[i], ray_hits[i]) : ReferenceHit{};
      if (!asked[i] && !is_defined(rays[i])) hits[i].kind = HitKind::undefined;
    }
  }
};

EmbreeScene::EmbreeScene(const Scene& scene, SphereMode spheres) : impl_(std::make_unique<Impl>()) {
  Impl& impl = *impl_;
  impl.mode = spheres;
  impl.ball = bounding_ball(scene);
  impl.scale = scale_for(impl.ball.radius);
  impl.spheres.scale = impl.scale;
  impl.positions = scene.positions;
  impl.triangles.reserve(scene.triangles.size());
  for (const Triangle& triangle : scene.triangles) impl.triangles.push_back(triangle.position);
  for (const Sphere& sphere : scene.spheres) impl.spheres.centers.push_back({glm::dvec3(sphere.center), sphere.radius});

  const KeepFloatingPoint keep;
  impl.device = rtcNewDevice(nullptr);
  if (impl.device == nullptr) throw EnvironmentError("Embree cannot open a device on this processor");
  impl.scene = rtcNewScene(impl.device);
  rtcSetSceneFlags(impl.scene, RTC_SCENE_FLAG_ROBUST);
  impl.add_triangles();
  impl.add_spheres();
  rtcCommitScene(impl.scene);
  impl.check();
}

EmbreeScene::~EmbreeScene() = default;
EmbreeScene::EmbreeScene(EmbreeScene&&) noexcept = default;
EmbreeScene& EmbreeScene::operator=(EmbreeScene&&) noexcept = default;

void EmbreeScene::intersect(std::span<const Ray> rays, std::span<ReferenceHit> hits) const {
  PLUMBLINE_ASSERT(rays.size() == hits.size());
  const std::size_t blocks = (rays.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t first = block * kBlock, count = std::min(kBlock, rays.size() - first);
    impl_->intersect_block(rays.subspan(first, count), hits.subspan(first, count));
  });
}

std::size_t EmbreeScene::intersect_only(std::span<const Ray> rays) const {
  using Range = tbb::blocked_range<std::size_t>;
  const auto trace = [&](const Range& range, std::size_t count) {
    const FlushDenormals flush;
    Context context;
    rtcInitIntersectContext(&context.base);
    RTCRayHit ray_hit{};
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Ray& given = rays[i];
      RTCRay& ray = ray_hit.ray;
      ray.org_x = given.origin.x, ray.org_y = given.origin.y, ray.org_z = given.origin.z;
      ray.dir_x = given.direction.x, ray.dir_y = given.direction.y, ray.dir_z = given.direction.z;
      ray.tnear = kNear, ray.tfar = given.t_max;
      ray.mask = 0xffffffffu;
      clear_hit(ray_hit);
      rtcIntersect1(impl_->scene, &context.base, &ray_hit);
      count += ray_hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return count;
  };
  return tbb::parallel_reduce(Range(0, rays.size(), 4 * kBlock), std::size_t{0}, trace, std::plus<>());
}

std::string EmbreeScene::version() { return "Embree " RTC_VERSION_STRING; }

}  // namespace plumbline
