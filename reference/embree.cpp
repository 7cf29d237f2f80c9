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

#include "reference/geometry.h"
#include "reference/hit_values.h"
#include "reference/instance_map.h"
#include "scenes/error.h"

namespace plumbline {

namespace {

constexpr unsigned kTriangleGeometry = 0, kSphereGeometry = 1;
/// Embree takes t = tnear for a hit, SEMANTICS leaves t = 0 out: the least t that is not flushed to zero.
constexpr float kNear = std::numeric_limits<float>::min();
constexpr std::size_t kBlock = 64;  ///< rays that one task converts, traces and evaluates at a time

/// What the sphere callback needs beside Embree's 32-bit ray. `base` comes first: Embree hands back a pointer to it.
struct Context {
  RTCIntersectContext base;
  const Line* line = nullptr;  ///< in the tree's space; null where the ray is to be taken as Embree has it (benchmark)
  double best = 0.0;           ///< s of the sphere that is the nearest hit so far, where one is
};

/// MXCSR with denormals flushed, as Embree asks for in each thread that traces, or kept, as our own arithmetic must see
/// them; put back afterwards.
class Denormals {
 public:
  enum Mode { kept, flushed };
  explicit Denormals(Mode mode) : saved_(_mm_getcsr()) {
    _mm_setcsr(mode == flushed ? saved_ | kFlush : saved_ & ~kFlush);
  }
  ~Denormals() { _mm_setcsr(saved_); }
  Denormals(const Denormals&) = delete;
  Denormals& operator=(const Denormals&) = delete;

 private:
  static constexpr unsigned kFlush = 0x8040u;
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

/// An ellipsoid is met where its sphere's line is; s stays what it is.
Line image_of(const Line& line, const TransformD& map) {
  Line result = line;
  result.point = transform_point(map, line.point);
  result.rest = transform_vector(map, line.rest);
  result.direction = transform_vector(map, line.direction);
  return result;
}

/// Throws where Embree has reported an error since the last call.
void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw EnvironmentError("Embree ran out of memory while building its tree");
  if (error != RTC_ERROR_NONE) throw EnvironmentError("Embree failed with error " + std::to_string(error));
}

void sphere_bounds(const RTCBoundsFunctionArguments* args);
void intersect_sphere(const RTCIntersectFunctionNArguments* args);
void occlude_sphere(const RTCOccludedFunctionNArguments* args);

/// Embree's tree over what one space holds. Its address must not change: callbacks have it.
struct Tree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::array<RTCGeometry, 2> attached{};  ///< by kTriangleGeometry and kSphereGeometry; null where there are none
  Geometry geometry;
  Ball ball;
  double scale = 1.0;  ///< from the space to what Embree has

  Tree(RTCDevice on, Geometry what, const Ball& around, SphereMode mode)
      : device(on), scene(rtcNewScene(on)), geometry(std::move(what)), ball(around), scale(scale_for(around.radius)) {
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    add_triangles();
    add_spheres(mode);
    rtcCommitScene(scene);
    check(device);
  }
  ~Tree() {
    for (const RTCGeometry one : attached)
      if (one != nullptr) rtcReleaseGeometry(one);
    rtcReleaseScene(scene);
  }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  float* new_buffer(RTCGeometry of, RTCBufferType type, RTCFormat format, std::size_t stride, std::size_t count) const {
    void* buffer = rtcSetNewGeometryBuffer(of, type, 0, format, stride, count);
    if (buffer == nullptr) check(device);
    PLUMBLINE_ASSERT(buffer != nullptr);
    return static_cast<float*>(buffer);
  }

  void attach(RTCGeometry one, unsigned number) {
    rtcCommitGeometry(one);
    rtcAttachGeometryByID(scene, one, number);
    attached[number] = one;
  }

  void add_triangles() {
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

  void add_spheres(SphereMode mode) {
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

  /// Fills Embree's ray up to s = `last` from the line's point. False where it cannot hit anything and Embree need not
  /// be asked.
  bool prepare(const Line& line, double last, RTCRayHit& ray_hit) const {
    if (!(line.t_max > 0.0) || !(last * scale > 0.0)) return false;  // it is empty, or ends before the scene
    if (line.shift < 0.0) return false;                              // the scene lies far behind the origin
    const glm::dvec3 origin = (line.point + line.rest) * scale;
    RTCRay& ray = ray_hit.ray;
    ray.org_x = static_cast<float>(origin.x), ray.org_y = static_cast<float>(origin.y),
    ray.org_z = static_cast<float>(origin.z);
    ray.dir_x = static_cast<float>(line.direction.x);
    ray.dir_y = static_cast<float>(line.direction.y);
    ray.dir_z = static_cast<float>(line.direction.z);
    ray.tnear = kNear;
    ray.tfar = static_cast<float>(last * scale);
    ray.time = 0.0f;
    ray.mask = 0xffffffffu;
    ray.id = ray.flags = 0;
    clear_hit(ray_hit);
    return true;
  }

  /// Embree's word on the nearest hit of a prepared ray.
  void find(const Line& line, RTCRayHit& ray_hit) const {
    const Denormals embree(Denormals::flushed);
    Context context;
    rtcInitIntersectContext(&context.base);
    context.line = &line;
    rtcIntersect1(scene, &context.base, &ray_hit);
  }
  /// Whether a line hits anything up to s = `last`.
  bool is_blocked(const Line& line, double last) const {
    RTCRayHit ray_hit;
    if (!prepare(line, last, ray_hit)) return false;
    const Denormals embree(Denormals::flushed);
    Context context;
    rtcInitIntersectContext(&context.base);
    context.line = &line;
    rtcOccluded1(scene, &context.base, &ray_hit.ray);
    return ray_hit.ray.tfar < 0.0f;  // Embree's sign for a hit
  }

  /// What Embree found, in the tree's space.
  ReferenceHit values(const Line& line, const RTCRayHit& ray_hit) const {
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
};

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& tree = *static_cast<const Tree*>(args->geometryUserPtr);
  BoxD box = box_of_round(tree.geometry, args->primID);
  if (tree.geometry.image(args->primID) != nullptr) {  // a few roundings in double were made
    const glm::dvec3 pad = 0x1p-45 * (glm::abs(box.lower) + glm::abs(box.upper));
    box = {box.lower - pad, box.upper + pad};
  }
  const glm::dvec3 lower = box.lower * tree.scale, upper = box.upper * tree.scale;
  RTCBounds& b = *args->bounds_o;
  b.lower_x = round_down(lower.x), b.lower_y = round_down(lower.y), b.lower_z = round_down(lower.z), b.align0 = 0.0f;
  b.upper_x = round_up(upper.x), b.upper_y = round_up(upper.y), b.upper_z = round_up(upper.z), b.align1 = 0.0f;
}

void intersect_sphere(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& tree = *static_cast<const Tree*>(args->geometryUserPtr);
  auto& context = *reinterpret_cast<Context*>(args->context);
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
  ray.tfar = std::min(ray.tfar, round_up(s_embree));
  ray_hit.hit.u = ray_hit.hit.v = 0.0f;
  ray_hit.hit.geomID = args->geomID;
  ray_hit.hit.primID = args->primID;
  ray_hit.hit.instID[0] = context.base.instID[0];
}

void occlude_sphere(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& tree = *static_cast<const Tree*>(args->geometryUserPtr);
  const Line* line = reinterpret_cast<const Context*>(args->context)->line;
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

/// A tree where it stands; `map` is null for the world's own.
struct Place {
  const Tree* tree = nullptr;
  const InstanceMap* map = nullptr;
  BoxD box;  ///< as Embree has it: scaled and padded
};

/// What the callback of places needs, and what it finds. `base` comes first.
struct PlacesContext {
  RTCIntersectContext base;
  const Ray* ray = nullptr;
  const Line* line = nullptr;  ///< near the whole scene
  double scale = 1.0;          ///< of the whole scene
  ReferenceHit best;
};

void place_bounds(const RTCBoundsFunctionArguments* args) {
  const BoxD& box = static_cast<const Place*>(args->geometryUserPtr)[args->primID].box;
  RTCBounds& b = *args->bounds_o;
  b.lower_x = round_down(box.lower.x), b.lower_y = round_down(box.lower.y), b.lower_z = round_down(box.lower.z);
  b.upper_x = round_up(box.upper.x), b.upper_y = round_up(box.upper.y), b.upper_z = round_up(box.upper.z);
  b.align0 = b.align1 = 0.0f;
}

/// How far a part's tree is searched: to t_max, and a little beyond the nearest hit so far, more than the search in 32
/// bits can misplace a hit, so that doubles decide.
double last_of(const Line& line, const Tree& tree, double best_t) {
  const double best = best_t / line.unit - line.shift;
  return std::min(line.t_max - line.shift, best + 0x1p-20 * (std::fabs(best) + 4.0 * tree.ball.radius));
}

void intersect_place(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const Denormals our_own(Denormals::kept);
  const Place& place = static_cast<const Place*>(args->geometryUserPtr)[args->primID];
  auto& places = *reinterpret_cast<PlacesContext*>(args->context);
  const Tree& tree = *place.tree;
  const Line line =
      place.map == nullptr ? line_near(*places.ray, tree.ball) : plain_local_line(*places.ray, *place.map, tree.ball);
  RTCRayHit found;
  if (!tree.prepare(line, last_of(line, tree, places.best.t), found)) return;
  tree.find(line, found);
  ReferenceHit hit = tree.values(line, found);
  if (hit.kind != HitKind::hit) return;
  if (place.map != nullptr) hit.instance = place.map->instance;
  const ReferenceHit& best = places.best;
  // The world, kNone, comes before all instances.
  if (!(hit.t < best.t || (hit.t == best.t && hit.instance + 1 < best.instance + 1))) return;
  if (place.map != nullptr) {
    hit.position = transform_point(place.map->to_world, hit.position);
    hit.normal = normal_to_world(*place.map, hit.normal);
  }
  places.best = hit;
  auto& ray_hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  const double s = hit.t / places.line->unit - places.line->shift;
  ray_hit.ray.tfar = std::min(ray_hit.ray.tfar, round_up(s * places.scale * (1.0 + 0x1p-20)));
  ray_hit.hit.geomID = args->geomID;
  ray_hit.hit.primID = args->primID;
}

void occlude_place(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const Denormals our_own(Denormals::kept);
  const Place& place = static_cast<const Place*>(args->geometryUserPtr)[args->primID];
  const auto& places = *reinterpret_cast<const PlacesContext*>(args->context);
  const Line line = place.map == nullptr ? line_near(*places.ray, place.tree->ball)
                                         : plain_local_line(*places.ray, *place.map, place.tree->ball);
  if (place.tree->is_blocked(line, line.t_max - line.shift)) reinterpret_cast<RTCRay*>(args->ray)->tfar = -INFINITY;
}

}  // namespace

struct EmbreeScene::Impl {
  RTCDevice device = nullptr;
  std::vector<std::unique_ptr<Tree>> trees;  ///< of the world, or all flattened into it; then of the parts
  std::vector<InstanceMap> maps;
  std::vector<Place> places;  ///< empty where trees[0] is all there is
  RTCScene over_places = nullptr;
  RTCScene instanced = nullptr;  ///< the same with Embree's own instances
  Ball ball;                     ///< around everything
  double scale = 1.0;            ///< for over_places

  Impl() : device(rtcNewDevice(nullptr)) {
    if (device == nullptr) throw EnvironmentError("Embree cannot open a device on this processor");
  }
  ~Impl() {
    for (const RTCScene scene : {over_places, instanced})
      if (scene != nullptr) rtcReleaseScene(scene);
    trees.clear();
    rtcReleaseDevice(device);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void add_parts(const Scene& scene, SphereMode mode) {
    for (const Part& part : scene.parts) {
      trees.push_back(std::make_unique<Tree>(device, part_geometry(scene, part), bounding_ball(scene, part), mode));
    }
  }

  void add_places(const Scene& scene) {
    maps = instance_maps(scene);
    scale = scale_for(ball.radius);
    // Embree's ray is off by a rounding of its origin, at most three radii from the centre, in each coordinate, and of
    // its direction over a way of at most six: 2^-24 (|centre| + 15 R) or so. This is 16 times that.
    const double pad = 0x1p-20 * (glm::length(ball.center) + 15.0 * ball.radius) * scale;
    std::vector<BoxD> boxes;
    for (const auto& tree : trees) boxes.push_back(box_of(tree->geometry));
    const auto add = [&](const Tree& tree, const InstanceMap* map, const BoxD& box) {
      places.push_back({&tree, map, {box.lower * scale - pad, box.upper * scale + pad}});
    };
    if (!(boxes[0].lower.x > boxes[0].upper.x)) add(*trees[0], nullptr, boxes[0]);
    for (const InstanceMap& map : maps) add(*trees[map.part + 1], &map, world_box(map, boxes[map.part + 1]));

    over_places = rtcNewScene(device);
    rtcSetSceneFlags(over_places, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(places.size()));
    rtcSetGeometryUserData(geometry, places.data());
    rtcSetGeometryBoundsFunction(geometry, place_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_place);
    rtcSetGeometryOccludedFunction(geometry, occlude_place);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(over_places, geometry, 0);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(over_places);
    check(device);
  }

  void add_instance(const Tree& tree, const TransformD& map) const {
    std::array<float, 12> matrix;  // column by column
    for (int column = 0; column < 4; ++column) {
      const glm::dvec3 v = column < 3 ? map.linear[column] / tree.scale : map.translation;
      for (int row = 0; row < 3; ++row) matrix[static_cast<std::size_t>(3 * column + row)] = static_cast<float>(v[row]);
    }
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, tree.scene);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(instanced, geometry);
    rtcReleaseGeometry(geometry);
  }

  void add_embree_instances() {
    instanced = rtcNewScene(device);
    rtcSetSceneFlags(instanced, RTC_SCENE_FLAG_ROBUST);
    if (trees[0]->scale == 1.0) {
      for (const RTCGeometry geometry : trees[0]->attached)
        if (geometry != nullptr) rtcAttachGeometry(instanced, geometry);
    } else {
      add_instance(*trees[0], {});
    }
    for (const InstanceMap& map : maps) add_instance(*trees[map.part + 1], map.to_world);
    rtcCommitScene(instanced);
    check(device);
  }

  void intersect_block(std::span<const Ray> rays, std::span<ReferenceHit> hits) const {
    const Tree& tree = *trees[0];
    std::array<Line, kBlock> lines;
    std::array<RTCRayHit, kBlock> ray_hits;
    std::array<bool, kBlock> asked;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      asked[i] = is_defined(rays[i]);
      if (asked[i]) lines[i] = line_near(rays[i], tree.ball);
      if (asked[i]) asked[i] = tree.prepare(lines[i], lines[i].t_max - lines[i].shift, ray_hits[i]);
    }
    {
      const Denormals embree(Denormals::flushed);
      Context context;
      rtcInitIntersectContext(&context.base);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        context.line = &lines[i];
        if (asked[i]) rtcIntersect1(tree.scene, &context.base, &ray_hits[i]);
      }
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      hits[i] = asked[i] ? tree.values(lines[i], ray_hits[i]) : ReferenceHit{};
      if (!asked[i] && !is_defined(rays[i])) hits[i].kind = HitKind::undefined;
    }
  }

  ReferenceHit intersect_places(const Ray& ray) const {
    ReferenceHit nothing;
    if (!is_defined(ray)) nothing.kind = HitKind::undefined;
    PlacesContext context;
    Line line;
    RTCRayHit ray_hit;
    if (!prepare_places(ray, line, context, ray_hit)) return nothing;
    const Denormals embree(Denormals::flushed);
    rtcIntersect1(over_places, &context.base, &ray_hit);
    return context.best;
  }

  bool is_blocked_by_places(const Ray& ray) const {
    PlacesContext context;
    Line line;
    RTCRayHit ray_hit;
    if (!prepare_places(ray, line, context, ray_hit)) return false;
    const Denormals embree(Denormals::flushed);
    rtcOccluded1(over_places, &context.base, &ray_hit.ray);
    return ray_hit.ray.tfar < 0.0f;
  }

  /// Fills Embree's ray for over_places, and what its callbacks need. False where the ray cannot hit anything.
  bool prepare_places(const Ray& ray, Line& line, PlacesContext& context, RTCRayHit& ray_hit) const {
    if (!is_defined(ray) || !(ray.t_max > 0.0f)) return false;
    rtcInitIntersectContext(&context.base);
    line = line_near(ray, ball);
    context.ray = &ray;
    context.line = &line;
    context.scale = scale;
    if (line.shift < 0.0) return false;  // the scene lies far behind the origin
    const double last = (line.t_max - line.shift) * scale;
    if (!(last > 0.0)) return false;
    const glm::dvec3 origin = (line.point + line.rest) * scale;
    RTCRay& embree_ray = ray_hit.ray;
    embree_ray = {};
    embree_ray.org_x = static_cast<float>(origin.x), embree_ray.org_y = static_cast<float>(origin.y),
    embree_ray.org_z = static_cast<float>(origin.z);
    embree_ray.dir_x = static_cast<float>(line.direction.x), embree_ray.dir_y = static_cast<float>(line.direction.y),
    embree_ray.dir_z = static_cast<float>(line.direction.z);
    embree_ray.tnear = 0.0f;
    embree_ray.tfar = round_up(last * (1.0 + 0x1p-20));
    embree_ray.mask = 0xffffffffu;
    clear_hit(ray_hit);
    return true;
  }
};

EmbreeScene::EmbreeScene(const Scene& scene, SphereMode spheres, Placement placement) {
  const KeepFloatingPoint keep;
  impl_ = std::make_unique<Impl>();
  Impl& impl = *impl_;
  impl.ball = bounding_ball(scene);
  if (placement == Placement::flattened) {
    PLUMBLINE_ASSERT(spheres == SphereMode::exact_user);
    impl.trees.push_back(std::make_unique<Tree>(impl.device, flattened_geometry(scene), impl.ball, spheres));
    return;
  }
  Geometry world = world_geometry(scene);
  if (scene.parts.empty()) {
    impl.trees.push_back(std::make_unique<Tree>(impl.device, std::move(world), impl.ball, spheres));
    return;
  }
  const BoxD box = box_of(world);
  Ball around;  // the world's own, where it has something
  if (!(box.lower.x > box.upper.x)) {
    around.center = 0.5 * (box.lower + box.upper);
    around.radius = 0.5 * glm::length(box.upper - box.lower) * (1.0 + 0x1p-40);
  }
  impl.trees.push_back(std::make_unique<Tree>(impl.device, std::move(world), around, spheres));
  impl.add_parts(scene, spheres);
  impl.add_places(scene);
  impl.add_embree_instances();
}

void EmbreeScene::move_nodes(const Scene& scene) {
  Impl& impl = *impl_;
  if (impl.over_places == nullptr) return;
  const KeepFloatingPoint keep;
  for (const RTCScene old : {impl.over_places, impl.instanced}) rtcReleaseScene(old);
  impl.over_places = impl.instanced = nullptr;
  impl.places.clear();
  impl.ball = bounding_ball(scene);
  impl.add_places(scene);
  impl.add_embree_instances();
}

EmbreeScene::~EmbreeScene() = default;
EmbreeScene::EmbreeScene(EmbreeScene&&) noexcept = default;
EmbreeScene& EmbreeScene::operator=(EmbreeScene&&) noexcept = default;

void EmbreeScene::intersect(std::span<const Ray> rays, std::span<ReferenceHit> hits) const {
  PLUMBLINE_ASSERT(rays.size() == hits.size());
  const std::size_t blocks = (rays.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t first = block * kBlock, count = std::min(kBlock, rays.size() - first);
    if (impl_->places.empty()) {
      impl_->intersect_block(rays.subspan(first, count), hits.subspan(first, count));
    } else {
      for (std::size_t i = first; i < first + count; ++i) hits[i] = impl_->intersect_places(rays[i]);
    }
  });
}

ReferenceHit EmbreeScene::first_hit(const Ray& ray) const {
  if (!impl_->places.empty()) return impl_->intersect_places(ray);
  ReferenceHit nothing;
  if (!is_defined(ray)) {
    nothing.kind = HitKind::undefined;
    return nothing;
  }
  const Tree& tree = *impl_->trees[0];
  const Line line = line_near(ray, tree.ball);
  RTCRayHit found;
  if (!tree.prepare(line, line.t_max - line.shift, found)) return nothing;
  tree.find(line, found);
  return tree.values(line, found);
}

bool EmbreeScene::is_blocked(const Ray& ray) const {
  if (!impl_->places.empty()) return impl_->is_blocked_by_places(ray);
  if (!is_defined(ray)) return false;
  const Line line = line_near(ray, impl_->trees[0]->ball);
  return impl_->trees[0]->is_blocked(line, line.t_max - line.shift);
}

std::size_t EmbreeScene::intersect_only(std::span<const Ray> rays) const {
  using Range = tbb::blocked_range<std::size_t>;
  const RTCScene scene = impl_->instanced != nullptr ? impl_->instanced : impl_->trees[0]->scene;
  const auto trace = [&](const Range& range, std::size_t count) {
    const Denormals embree(Denormals::flushed);
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
      rtcIntersect1(scene, &context.base, &ray_hit);
      count += ray_hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return count;
  };
  return tbb::parallel_reduce(Range(0, rays.size(), 4 * kBlock), std::size_t{0}, trace, std::plus<>());
}

}  // namespace plumbline
