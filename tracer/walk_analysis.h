// SPDX-License-Identifier: MIT
// What captured walks tell: where two of them part, and where a walk lost a primitive that it should have hit. Nothing
// is traced again.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tracer/walk_trace.h"

namespace plumbline {

inline constexpr std::size_t kNoStep = std::numeric_limits<std::size_t>::max();

/// Where two walks differ for the first time.
struct Divergence {
  std::size_t step = 0;  ///< index into both walks' steps; into the longer one's where the other has ended
  std::string what;      ///< "the first visits cell (3, 0), the second (7, 0)"
};

/// Compares walks of one ray step by step, every number by its bits: through images of one layout, through an image and
/// its patched self, or by two drivers or programs. Nothing where they are the same.
std::optional<Divergence> first_divergence(const Walk& a, const Walk& b);

/// What exact arithmetic says is hit.
struct ExpectedHit {
  std::uint32_t instance = kNone, primitive = kNone;
  double t = std::numeric_limits<double>::quiet_NaN();  ///< of the ray as given; NaN: not known
};

enum class LossKind {
  none,       ///< the walk ended in this very hit
  nearer,     ///< something else was found that is not farther by the walk's own numbers
  bounds,     ///< a node's volume rejected the ray
  link,       ///< a link led past what it should lead to
  way_in,     ///< a transform took the ray, or the walk, elsewhere
  way_out,    ///< a transform was not left, or left to the wrong place
  leaf,       ///< the leaf was entered, but the primitive was not tested
  primitive,  ///< the primitive was tested and rejected
  capped,     ///< the walk went on and on, before it got there
  absent,     ///< the image does not hold the primitive, or not there
  unknown,    ///< what was captured does not tell
};

/// A node above the primitive, or the leaf that holds it, or the leaf of a transform on the way to it.
struct Ancestor {
  std::uint32_t space = kNone;      ///< the node whose space it stands in
  std::uint32_t cell = 0;           ///< in the copy that the walk is in
  int x = 0, y = 0;                 ///< of its (upper) texel
  std::uint32_t node = 0;           ///< its number within the copy
  std::uint32_t transform = kNone;  ///< the scene's node that this leaf leads into
  std::size_t step = kNoStep;       ///< where the walk visited it
};

/// Who lost it.
struct Loss {
  LossKind kind = LossKind::unknown;
  std::size_t step = kNoStep;  ///< index of the step at fault
  std::uint32_t space = kNone;
  std::uint32_t cell = kNone, node = kNone;  ///< of the node at fault: a node that rejected, a link's; kNone: none
  int x = -1, y = -1;
  std::uint32_t transform = kNone;  ///< way_in, way_out: the scene's node at fault
  /// bounds, spheres: from the centre to the ray's segment and the radius, in units of the image and its space, and
  /// what the radius lacks. Boxes: t at which the ray enters and leaves, and what the second lacks.
  double distance = 0.0, radius = 0.0, shortfall = 0.0;
  /// bounds, spheres: the same shortfall in world units; NaN where the way to the world stretches some directions more
  /// than others.
  double world_shortfall = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t expected_cell = kNone, reached_cell = kNone;  ///< link, way_out; kNone: an end
  std::optional<TestedPrimitive> test;                        ///< primitive, nearer: of the primitive itself
  std::uint32_t stored = kNone;  ///< leaf, where a sound image was given: the stored primitive whose label is wrong
  /// Where a sound image was given: whether the texels of what is at fault are those of the sound one. Then the image
  /// is not to blame but the arithmetic, the driver or the ray.
  std::optional<bool> as_baked;
  std::vector<Ancestor> chain;  ///< from the world's root to the leaf of the primitive
  std::string sentence;         ///< all of this for a reader
};

/// Finds where the walk, through this image, lost a primitive. What stands below what, and where links should lead, is
/// read from `sound`, a bake of the same scene with the same options that is known to be right; where there is none,
/// from the image itself: then a link that leads too far looks like a volume that rejects, unless the nesting of nodes
/// shows it. Of a primitive that stands in several leaves, the one whose volume holds the point at `expected.t` counts.
/// Throws InputError where `sound` is of another shape.
Loss lost_at(const GeometryImage& image, const Walk& walk, const ExpectedHit& expected,
             const GeometryImage* sound = nullptr);

/// "sphere of node 57 at cell (114, 12) rejected the ray; ...": Loss::sentence.
std::string describe(const Loss& loss, const GeometryImage& image, const ExpectedHit& expected);

/// "bounds", "link", ...
const char* name_of(LossKind kind);

}  // namespace plumbline
