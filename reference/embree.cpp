// SPDX-License-Identifier: GPL-3.0-or-later
// A scene for Embree: the world's tree, or all places where trees stand, each once. Everything Embree's own stays in
// this file and embree_tree.cpp.
#include "reference/embree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/embree_tree.h"
#include "reference/instance_map.h"
#include "scenes/error.h"

namespace plumbline {

namespace {

constexpr std::size_t kBlock = 64;  ///< rays that one task converts, traces and evaluates at a time

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

/// A tree where it stands; `map` is null for the world's own.
struct Place {
  const EmbreeTree* tree = nullptr;
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
  b.lower_x = float_below(box.lower.x), b.lower_y = float_below(box.lower.y), b.lower_z = float_below(box.lower.z);
  b.upper_x = float_above(box.upper.x), b.upper_y = float_above(box.upper.y), b.upper_z = float_above(box.upper.z);
  b.align0 = b.align1 = 0.0f;
}

/// How far a part's tree is searched: to t_max, and a little beyond the nearest hit so far, more than the search in 32
/// bits can misplace a hit, so that doubles decide.
double last_of(const Line& line, const EmbreeTree& tree, double best_t) {
  const double best = best_t / line.unit - line.shift;
  return std::min(line.t_max - line.shift, best + 0x1p-20 * (std::fabs(best) + 4.0 * tree.ball.radius));
}

void intersect_place(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const Denormals our_own(Denormals::kept);
  const Place& place = static_cast<const Place*>(args->geometryUserPtr)[args->primID];
  auto& places = *reinterpret_cast<PlacesContext*>(args->context);
  const EmbreeTree& tree = *place.tree;
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
  ray_hit.ray.tfar = std::min(ray_hit.ray.tfar, float_above(s * places.scale * (1.0 + 0x1p-20)));
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
  std::vector<std::unique_ptr<EmbreeTree>> trees;  ///< of the world, or all flattened into it; then of the parts
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
      trees.push_back(
          std::make_unique<EmbreeTree>(device, part_geometry(scene, part), bounding_ball(scene, part), mode));
    }
  }

  void add_places(const Scene& scene) {
    maps = instance_maps(scene);
    scale = embree_scale(ball.radius);
    // Embree's ray is off by a rounding of its origin, at most three radii from the centre, in each coordinate, and of
    // its direction over a way of at most six: 2^-24 (|centre| + 15 R) or so. This is 16 times that.
    const double pad = 0x1p-20 * (glm::length(ball.center) + 15.0 * ball.radius) * scale;
    std::vector<BoxD> boxes;
    for (const auto& tree : trees) boxes.push_back(box_of(tree->geometry));
    const auto add = [&](const EmbreeTree& tree, const InstanceMap* map, const BoxD& box) {
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
    check_embree(device);
  }

  void add_instance(const EmbreeTree& tree, const TransformD& map) const {
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
    check_embree(device);
  }

  void intersect_block(std::span<const Ray> rays, std::span<ReferenceHit> hits) const {
    const EmbreeTree& tree = *trees[0];
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
      EmbreeContext context;
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
    embree_ray.tfar = float_above(last * (1.0 + 0x1p-20));
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
    impl.trees.push_back(std::make_unique<EmbreeTree>(impl.device, flattened_geometry(scene), impl.ball, spheres));
    return;
  }
  Geometry world = world_geometry(scene);
  if (scene.parts.empty()) {
    impl.trees.push_back(std::make_unique<EmbreeTree>(impl.device, std::move(world), impl.ball, spheres));
    return;
  }
  const BoxD box = box_of(world);
  Ball around;  // the world's own, where it has something
  if (!(box.lower.x > box.upper.x)) {
    around.center = 0.5 * (box.lower + box.upper);
    around.radius = 0.5 * glm::length(box.upper - box.lower) * (1.0 + 0x1p-40);
  }
  impl.trees.push_back(std::make_unique<EmbreeTree>(impl.device, std::move(world), around, spheres));
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
  const EmbreeTree& tree = *impl_->trees[0];
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
    EmbreeContext context;
    rtcInitIntersectContext(&context.base);
    RTCRayHit ray_hit{};
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Ray& given = rays[i];
      RTCRay& ray = ray_hit.ray;
      ray.org_x = given.origin.x, ray.org_y = given.origin.y, ray.org_z = given.origin.z;
      ray.dir_x = given.direction.x, ray.dir_y = given.direction.y, ray.dir_z = given.direction.z;
      ray.tnear = kEmbreeNear, ray.tfar = given.t_max;
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