// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/embree_tree.h"

#include <algorithm>
#include <cmath>

#include "reference/hit_values.h"
#include "scenes/error.h"

namespace plumbline {

namespace {

constexpr unsigned kTriangleGeometry = 0, kSphereGeometry = 1;

/// An ellipsoid is met where its sphere's line is; s stays what it is.
Line image_of(const Line& line, const TransformD& map) {
  Line result = line;
  result.point = transform_point(map, line.point);
  result.rest = transform_vector(map, line.rest);
  result.direction = transform_vector(map, line.direction);
  return result;
}

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& tree = *static_cast<const EmbreeTree*>(args->geometryUserPtr);
  BoxD box = box_of_round(tree.geometry, args->primID);
  if (tree.geometry.image(args->primID) != nullptr) {  // a few roundings in double were made
    const glm::dvec3 pad = 0x1p-45 * (glm::abs(box.lower) + glm::abs(box.upper));
    box = {box.lower - pad, box.upper + pad};
  }
  const glm::dvec3 lower = box.lower * tree.scale, upper = box.upper * tree.scale;
  RTCBounds& b = *args->bounds_o;
  b.lower_x = float_below(lower.x), b.lower_y = float_below(lower.y), b.lower_z = float_below(lower.z), b.align0 = 0.0f;
  b.upper_x = float_above(upper.x), b.upper_y = float_above(upper.y), b.upper_z = float_above(upper.z), b.align1 = 0.0f;
}

void intersect_sphere(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& tree = *static_cast<const EmbreeTree*>(args->geometryUserPtr);
  auto& context = *reinterpret_cast<EmbreeContext*>(args->context);
  auto& ray_hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  RTCRay& ray = ray_hit.ray;
  const auto& [center, radius] = tree.geometry.rounds[args->primID];

  Line other;
  const Line* line = context.line;
  if (line == nullptr) {
    other.point = {ray.org_x, ray.org_y, ray.org_z};
    other.direction = {ray.dir_x, ray.dir_y, ray.dir_z};
    line = &other;
  }
  if (const Image* const image = tree.geometry.image(args->primID); image != nullptr) {
    other = image_of(*line, image->from_here);
    line = &other;
  }
  const SphereRoots roots = sphere_roots(*line, center, radius);
  if (!roots.met) return;
  const double s = nearest_root(*line, roots);
  if (!(line->shift + s > 0.0)) return;
  if (context.line != nullptr && !(line->shift + s <= line->t_max)) return;
  // Between spheres doubles decide; against triangles Embree's own t is all there is.
  const double s_embree = s * tree.scale;
  if (context.line != nullptr && ray_hit.hit.geomID == kSphereGeometry) {
    if (!(s < context.best)) return;
  } else if (!(s_embree <= static_cast<double>(ray.tfar))) {
    return;
  }
  context.best = s;
  ray.tfar = std::min(ray.tfar, float_above(s_embree));
  ray_hit.hit.u = ray_hit.hit.v = 0.0f;
  ray_hit.hit.geomID = args->geomID;
  ray_hit.hit.primID = args->primID;
  ray_hit.hit.instID[0] = context.base.instID[0];
}

void occlude_sphere(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& tree = *static_cast<const EmbreeTree*>(args->geometryUserPtr);
  const Line* line = reinterpret_cast<const EmbreeContext*>(args->context)->line;
  const auto& [center, radius] = tree.geometry.rounds[args->primID];
  Line other;
  if (const Image* const image = tree.geometry.image(args->primID); image != nullptr) {
    other = image_of(*line, image->from_here);
    line = &other;
  }
  const SphereRoots roots = sphere_roots(*line, center, radius);
  if (!roots.met) return;
  const double s = line->shift + nearest_root(*line, roots);
  if (s > 0.0 && s <= line->t_max) reinterpret_cast<RTCRay*>(args->ray)->tfar = -INFINITY;
}

}  // namespace

float float_below(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -INFINITY) : f;
}
float float_above(double x) { return -float_below(-x); }

double embree_scale(double radius) {
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

void check_embree(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw EnvironmentError("Embree ran out of memory while building its tree");
  if (error != RTC_ERROR_NONE) throw EnvironmentError("Embree failed with error " + std::to_string(error));
}

EmbreeTree::EmbreeTree(RTCDevice on, Geometry what, const Ball& around, SphereMode mode)
    : device(on), scene(rtcNewScene(on)), geometry(std::move(what)), ball(around), scale(embree_scale(around.radius)) {
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  add_triangles();
  add_spheres(mode);
  rtcCommitScene(scene);
  check_embree(device);
}

EmbreeTree::~EmbreeTree() {
  for (const RTCGeometry one : attached)
    if (one != nullptr) rtcReleaseGeometry(one);
  rtcReleaseScene(scene);
}

float* EmbreeTree::new_buffer(RTCGeometry of, RTCBufferType type, RTCFormat format, std::size_t stride,
                              std::size_t count) const {
  void* buffer = rtcSetNewGeometryBuffer(of, type, 0, format, stride, count);
  if (buffer == nullptr) check_embree(device);
  PLUMBLINE_ASSERT(buffer != nullptr);
  return static_cast<float*>(buffer);
}

void EmbreeTree::attach(RTCGeometry one, unsigned number) {
  rtcCommitGeometry(one);
  rtcAttachGeometryByID(scene, one, number);
  attached[number] = one;
}

void EmbreeTree::add_triangles() {
  const auto& triangles = geometry.triangles;
  if (triangles.empty()) return;
  const RTCGeometry one = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const std::size_t count = std::max(geometry.positions.size(), geometry.fine_positions.size());
  float* vertices = new_buffer(one, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), count);
  for (const auto& p : geometry.positions) {
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(p[axis] * scale);
  }
  for (const auto& p : geometry.fine_positions) {
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(p[axis] * scale);
  }
  float* indices = new_buffer(one, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, sizeof(triangles[0]), triangles.size());
  std::copy(triangles.begin(), triangles.end(), reinterpret_cast<std::array<std::uint32_t, 3>*>(indices));
  attach(one, kTriangleGeometry);
}

void EmbreeTree::add_spheres(SphereMode mode) {
  const auto& rounds = geometry.rounds;
  if (rounds.empty()) return;
  if (mode == SphereMode::embree) {
    const RTCGeometry one = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    float* buffer = new_buffer(one, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), rounds.size());
    for (const auto& [center, radius] : rounds) {
      for (int axis = 0; axis < 3; ++axis) *buffer++ = static_cast<float>(center[axis] * scale);
      *buffer++ = static_cast<float>(radius * scale);
    }
    attach(one, kSphereGeometry);
    return;
  }
  const RTCGeometry one = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(one, static_cast<unsigned>(rounds.size()));
  rtcSetGeometryUserData(one, this);
  rtcSetGeometryBoundsFunction(one, sphere_bounds, nullptr);
  rtcSetGeometryIntersectFunction(one, intersect_sphere);
  rtcSetGeometryOccludedFunction(one, occlude_sphere);
  attach(one, kSphereGeometry);
}

bool EmbreeTree::prepare(const Line& line, double last, RTCRayHit& ray_hit) const {
  if (!(line.t_max > 0.0) || !(last * scale > 0.0)) return false;  // it is empty, or ends before the scene
  if (line.shift < 0.0) return false;                              // the scene lies far behind the origin
  const glm::dvec3 origin = (line.point + line.rest) * scale;
  RTCRay& ray = ray_hit.ray;
  ray.org_x = static_cast<float>(origin.x), ray.org_y = static_cast<float>(origin.y),
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(line.direction.x);
  ray.dir_y = static_cast<float>(line.direction.y);
  ray.dir_z = static_cast<float>(line.direction.z);
  ray.tnear = kEmbreeNear;
  ray.tfar = static_cast<float>(last * scale);
  ray.time = 0.0f;
  ray.mask = 0xffffffffu;
  ray.id = ray.flags = 0;
  clear_hit(ray_hit);
  return true;
}

void EmbreeTree::find(const Line& line, RTCRayHit& ray_hit) const {
  const Denormals embree(Denormals::flushed);
  EmbreeContext context;
  rtcInitIntersectContext(&context.base);
  context.line = &line;
  rtcIntersect1(scene, &context.base, &ray_hit);
}

bool EmbreeTree::is_blocked(const Line& line, double last) const {
  RTCRayHit ray_hit;
  if (!prepare(line, last, ray_hit)) return false;
  const Denormals embree(Denormals::flushed);
  EmbreeContext context;
  rtcInitIntersectContext(&context.base);
  context.line = &line;
  rtcOccluded1(scene, &context.base, &ray_hit.ray);
  return ray_hit.ray.tfar < 0.0f;  // Embree's sign for a hit
}

ReferenceHit EmbreeTree::values(const Line& line, const RTCRayHit& ray_hit) const {
  const std::uint32_t number = ray_hit.hit.primID;
  if (ray_hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  ReferenceHit hit;
  Geometry::Source source;
  if (ray_hit.hit.geomID == kTriangleGeometry) {
    hit = triangle_values(line, geometry.corners(number), ray_hit.ray.tfar / scale);
    source = geometry.source_of_triangle(number);
    if (source.turned) hit.normal = -hit.normal;
  } else {
    const auto& [center, radius] = geometry.rounds[number];
    source = geometry.source_of_sphere(number);
    const Image* const image = geometry.image(number);
    if (image == nullptr) {
      hit = sphere_values(line, center, radius);
    } else {
      hit = sphere_values(image_of(line, image->from_here), center, radius);
      hit.position = transform_point(image->to_here, hit.position);
      hit.normal = glm::normalize(glm::transpose(image->from_here.linear) * hit.normal);
    }
  }
  hit.primitive = source.primitive;
  hit.instance = source.instance;
  return hit;
}

}  // namespace plumbline
