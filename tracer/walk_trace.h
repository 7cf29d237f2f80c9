// SPDX-License-Identifier: MIT
// The production shader's own walk of one ray, step by step. It is captured from the GPU, not re-enacted: the program
// is the production's with hooks that write down what it computes, all pixels of a pass walk the same ray, and pixel i
// keeps event i.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scenes/ray.h"
#include "tracer/geometry_image.h"
#include "tracer/gl_context.h"
#include "tracer/shader_source.h"

namespace plumbline {

/// What came of a node's test. The order of the segment's ends is told from the shader's own numbers.
enum class NodeTest {
  hit,
  missed,        ///< the ray's line passes the volume
  behind,        ///< the volume lies before the ray's start
  beyond,        ///< it lies behind the nearest hit so far, or t_max
  end,           ///< no node but the end of a region (layout `compact`)
  not_a_number,  ///< the test compared a NaN
};

/// What came of a primitive's test.
enum class PrimitiveTest {
  new_nearest,
  outside,       ///< the ray passes it
  behind,        ///< t is not above t_low
  farther,       ///< t is above the nearest so far, or t_max
  tie_lost,      ///< t equals the nearest so far, whose node or number is lower
  edge_on,       ///< a triangle seen edge-on: it is resolved next, and stands in the list once more
  not_a_number,  ///< t is none
};

struct TestedPrimitive {
  std::uint32_t primitive = kNone;  ///< number in the scene; kNone where the label is none
  std::uint32_t k = 0;              ///< where it is stored
  bool is_sphere = false;
  bool is_last = false;   ///< of its cluster
  bool resolved = false;  ///< by the exact arithmetic for triangles seen edge-on
  PrimitiveTest outcome = PrimitiveTest::outside;
  float t = 0.0f;        ///< by the walking ray of the space at hand
  float t_world = 0.0f;  ///< by the world's walking ray: what is compared
  glm::vec2 weights{0.0f};
  float t_low = 0.0f;           ///< hits in this space have a t above it
  float nearest_before = 0.0f;  ///< t_world of the nearest hit (or of t_max) when it was tested ...
  float nearest_after = 0.0f;   ///< ... and after it
  glm::vec4 numbers{0.0f};      ///< triangle: the three edge functions and their sum; sphere: t of the perpendicular's
                                ///< foot, half the chord in t, radius^2 - distance^2, 0
};

/// A ray as it walks in one space: o + t d, in image units.
struct SpaceRay {
  glm::vec3 o{0.0f}, d{0.0f};
  float t_scale = 1.0f, t_shift = 0.0f;  ///< t of the world's walking ray = t * t_scale + t_shift
  float t_low = 0.0f;                    ///< hits have a t above it: less than 0 where the ray was moved from afar
  float bound = 0.0f;                    ///< no nearer hit has a t above it
};

struct SpaceChange {
  enum class Kind {
    started,  ///< the walk begins
    resumed,  ///< it goes on in another pass, as in production, and the ray was made anew
    entered,  ///< the space of `node`
    missed,   ///< entered it, found that the ray misses all that stands there, and left at once (`left` follows)
    left,     ///< the space of `node`
  };
  Kind kind = Kind::started;
  std::uint32_t node = kNone;   ///< of the scene
  std::uint32_t space = kNone;  ///< that the walk is in afterwards: a node, or kNone: the world
  std::uint32_t copy = 0;       ///< of its region, by octant
  SpaceRay ray;                 ///< there
};

/// A node visited, and all that happened until the next one.
struct WalkStep {
  std::uint32_t number = 0;     ///< as Hit::steps counts, from 1
  bool again = false;           ///< the same leaf once more, for the primitives behind one that interrupted the walk
  std::uint32_t space = kNone;  ///< the node whose space is walked; kNone: the world
  std::uint32_t cell = 0;       ///< compact: texel; paper: cell
  int x = 0, y = 0;             ///< of its (upper) texel, as it was read
  std::uint32_t copy = kNone;   ///< of the region, by octant; kNone: outside of the space's region
  std::uint32_t node = kNone;   ///< its number within the copy, in the order of the image; kNone as above
  NodeTest test = NodeTest::missed;
  float bound = 0.0f;  ///< t up to which the node counts: nearest.t
  // Bounds `sphere`: as the shader computed them.
  float distance2 = 0.0f, radius2 = 0.0f;    ///< from the centre to the segment, squared, and what it was compared to
  float foot = 0.0f, line_distance2 = 0.0f;  ///< t of the line's point next to the centre, and how far away that is
  float enter = 0.0f, leave = 0.0f;          ///< bounds `aabb`: t of the slabs, without 0 and the bound
  float word = 0.0f;                         ///< w of its texel
  glm::vec2 link{0.0f};                      ///< layout `paper`: the link taken
  std::vector<TestedPrimitive> primitives;   ///< of its cluster, in order
  std::vector<SpaceChange> changes;          ///< in order
  bool ended = false;                        ///< the walk's end was reached
  std::uint32_t next = kNone;                ///< cell visited next; kNone: none
};

struct Walk {
  Ray ray;
  SpaceChange start;  ///< the ray as it begins to walk
  std::vector<WalkStep> steps;
  Hit hit;  ///< in which this very walk ended
  /// Events (nodes and primitives tested, changes of space) behind the last step that were not captured, because there
  /// were more than the limit. The hit is the whole walk's all the same.
  std::uint64_t skipped = 0;
  /// False: pixels that walked the same ray with the same code came to different ends. That is the driver's fault.
  bool driver_agrees = true;
  int passes = 0;
  double seconds = 0.0;  ///< in the driver, without compiling
};

inline constexpr std::size_t kMostEvents = std::size_t{1} << 17;
inline constexpr int kEventsPerPass = 960;

/// Captures walks through one image. Both must outlive it. Compiles one program, and a second when a ray first needs
/// the code for triangles seen edge-on or origins very far away.
///
/// What is captured is what Probe computes, with these exceptions. (1) A walk longer than the driver's loops (65,535
/// iterations in Mesa 22.3) is cut there by the driver in production, which then derives the ray of the space at hand
/// anew; here passes are shorter, and a walk goes on with the very ray that it had. With transforms that come out by
/// `inverse` its t may differ in the last places. (2) Of a walk with more events than the limit the rest is walked, but
/// not captured: Walk::skipped.
class WalkRecorder {
 public:
  /// Throws as Probe's constructor does.
  WalkRecorder(GlContext& context, const GeometryImage& image, std::span<const ShaderPatch> patches = {});
  ~WalkRecorder();
  WalkRecorder(WalkRecorder&&) noexcept;
  WalkRecorder& operator=(WalkRecorder&&) noexcept;

  /// Takes another image. Compiles nothing if it needs the code of one that this recorder has held before.
  void set_image(const GeometryImage& image);

  /// `events_per_pass` does not change what is captured: a test of that sets it.
  Walk record(const Ray& ray, std::size_t most_events = kMostEvents, int events_per_pass = kEventsPerPass);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Captures one walk.
Walk capture_walk(GlContext& context, const GeometryImage& image, const Ray& ray,
                  std::span<const ShaderPatch> patches = {});

/// "hit", "missed", "beyond", ...
const char* name_of(NodeTest test);
const char* name_of(PrimitiveTest test);

/// A step in a line: "7: cell (114, 0), node 57: entered (distance^2 0.31, radius^2 1.2)".
std::string describe(const WalkStep& step, Bounds bounds);

}  // namespace plumbline
