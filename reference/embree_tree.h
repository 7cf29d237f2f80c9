// SPDX-License-Identifier: GPL-3.0-or-later
// Embree's tree over what one space holds, for embree.cpp alone: Embree finds the primitive, doubles say where it is
// met.
#pragma once

#include <embree3/rtcore.h>
#include <xmmintrin.h>

#include <array>
#include <limits>

#include "reference/embree.h"
#include "reference/geometry.h"
#include "reference/line.h"

namespace plumbline {

/// Embree takes t = tnear for a hit, SEMANTICS leaves t = 0 out: the least t that is not flushed to zero.
inline constexpr float kEmbreeNear = std::numeric_limits<float>::min();

/// What the sphere callback needs beside Embree's 32-bit ray. `base` comes first: Embree hands back a pointer to it.
struct EmbreeContext {
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

/// A double as the float next below it, and next above it.
float float_below(double x);
float float_above(double x);

/// A power of two that brings the radius into [2^-20, 2^20]: Embree multiplies three coordinates in 32 bits. 1 for most
/// scenes.
double embree_scale(double radius);

void clear_hit(RTCRayHit& ray_hit);

/// Throws where Embree has reported an error since the last call.
void check_embree(RTCDevice device);

/// Embree's tree over what one space holds. Its address must not change: callbacks have it.
struct EmbreeTree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::array<RTCGeometry, 2> attached{};  ///< triangles and spheres; null where there are none
  Geometry geometry;
  Ball ball;
  double scale = 1.0;  ///< from the space to what Embree has

  EmbreeTree(RTCDevice on, Geometry what, const Ball& around, SphereMode mode);
  ~EmbreeTree();
  EmbreeTree(const EmbreeTree&) = delete;
  EmbreeTree& operator=(const EmbreeTree&) = delete;

  /// Fills Embree's ray up to s = `last` from the line's point. False where it cannot hit anything and Embree need not
  /// be asked.
  bool prepare(const Line& line, double last, RTCRayHit& ray_hit) const;
  /// Embree's word on the nearest hit of a prepared ray.
  void find(const Line& line, RTCRayHit& ray_hit) const;
  /// Whether a line hits anything up to s = `last`.
  bool is_blocked(const Line& line, double last) const;
  /// What Embree found, in the tree's space.
  ReferenceHit values(const Line& line, const RTCRayHit& ray_hit) const;

 private:
  float* new_buffer(RTCGeometry of, RTCBufferType type, RTCFormat format, std::size_t stride, std::size_t count) const;
  void attach(RTCGeometry one, unsigned number);
  void add_triangles();
  void add_spheres(SphereMode mode);
};

}  // namespace plumbline
