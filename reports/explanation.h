// SPDX-License-Identifier: MIT
// The explanation of one ray, as plain data, and its faces: a JSON document (explanation.schema.json) and a page. It
// holds the tracer's walk step by step, the truth, and where the two part.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace plumbline {

/// No node, cell or primitive; null in JSON.
inline constexpr std::uint32_t kNoNumber = std::numeric_limits<std::uint32_t>::max();

/// A primitive that the walk tested. Numbers are the shader's own 32 bits.
struct PrimitiveStepRecord {
  std::uint32_t primitive = kNoNumber, stored = 0;  ///< number in the scene, and where the image stores it
  std::string outcome;                              ///< "new_nearest", "outside", "behind", "farther", "tie_lost", ...
  bool is_sphere = false, is_last = false, resolved = false;
  float t = 0.0f, t_world = 0.0f, t_low = 0.0f;  ///< of the space at hand; of the world's walking ray
  float nearest_before = 0.0f, nearest_after = 0.0f;
  std::array<float, 2> weights{};
  std::array<float, 4> numbers{};  ///< triangle: edge functions and their sum; sphere: foot, half chord, what is left
};

/// A change of space, with the ray as it walks there: o + t d in image units.
struct SpaceStepRecord {
  std::string kind;  ///< "started", "resumed", "entered", "missed", "left"
  std::uint32_t node = kNoNumber, space = kNoNumber, copy = 0;
  std::array<float, 3> o{}, d{};
  float t_scale = 1.0f, t_shift = 0.0f, t_low = 0.0f, bound = 0.0f;
};

/// A node that the walk visited, and all that happened until the next one.
struct StepRecord {
  std::uint32_t number = 0;  ///< as the tracer counts its steps, from 1
  bool again = false;        ///< the same leaf once more
  std::uint32_t space = kNoNumber, cell = 0;
  int x = 0, y = 0;  ///< of its (upper) texel
  std::uint32_t copy = kNoNumber, node = kNoNumber;
  std::string test;    ///< the shader's node test: "hit", "missed", "behind", "beyond", "end", "not_a_number"
  std::string reason;  ///< of the way taken, see kWalkReasons
  float bound = 0.0f;  ///< t up to which the node counts
  float distance2 = 0.0f, radius2 = 0.0f, foot = 0.0f, line_distance2 = 0.0f;  ///< spheres
  float enter = 0.0f, leave = 0.0f;                                            ///< boxes
  float word = 0.0f;
  std::array<float, 2> link{};
  std::vector<PrimitiveStepRecord> primitives;
  std::vector<SpaceStepRecord> changes;
  bool ended = false;
  std::uint32_t next = kNoNumber;
  bool on_chain = false;  ///< it visits a node above the truth's primitive
  bool notable = false;   ///< shown first: on the chain, a change of space or of the nearest hit, first, last, at fault
};

/// What StepRecord::reason may be.
inline constexpr std::array<std::string_view, 12> kWalkReasons{
    "miss",        "behind",       "beyond t_max",     "beyond nearest", "entered", "leaf tested",
    "new nearest", "transform in", "transform missed", "transform out",  "end",     "not a number"};

/// A node above the truth's primitive.
struct AncestorRecord {
  std::uint32_t space = kNoNumber, cell = 0, node = 0;
  int x = 0, y = 0;
  std::uint32_t transform = kNoNumber;  ///< that its leaf leads into
  std::uint32_t step = kNoNumber;       ///< index of the step that visited it; kNoNumber: none did
};

/// Where the walk and the truth part.
struct FaultRecord {
  std::string kind;                ///< "bounds", "link", "way_in", ...: none of them where nothing was lost: "none"
  std::uint32_t step = kNoNumber;  ///< index into the steps
  std::uint32_t space = kNoNumber, cell = kNoNumber, node = kNoNumber, transform = kNoNumber;
  int x = -1, y = -1;
  double shortfall = 0.0;  ///< bounds: what the radius lacks, or the box in t
  std::string as_baked;    ///< "yes", "no", or empty: there is no sound image to tell
};

/// A shape in the plane of the picture: world units, x along the ray from its origin, y across it.
struct ShapeRecord {
  std::string role;                ///< "entered", "rejected", "fault", "truth", "answer"
  std::string label;               ///< "node 57 at cell (114, 12)"
  std::uint32_t step = kNoNumber;  ///< index into the steps
  bool is_ellipse = false;
  double x = 0.0, y = 0.0, rx = 0.0, ry = 0.0, angle = 0.0;  ///< centre, half axes, turn of the first in radians
  std::vector<std::array<double, 2>> points;                 ///< of a polygon, or the ends of a line
};

/// A point on the ray.
struct MarkRecord {
  std::string role;  ///< "origin", "truth", "answer", "t_max"
  std::string label;
  double x = 0.0;  ///< world units from the origin
};

/// A cut through what the ray met, by a plane that holds the ray.
struct SliceRecord {
  double length = 0.0;  ///< of the ray's direction: x = t * length
  std::vector<ShapeRecord> shapes;
  std::vector<MarkRecord> marks;
  std::uint64_t left_out = 0;  ///< volumes that the walk tested and that are not drawn: they are too many
  std::uint64_t not_cut = 0;   ///< that the plane does not meet
};

/// Two walks of one ray.
struct ComparisonRecord {
  std::string with;           ///< "variant paper_sphere_threaded", "other.exr", "walk.json (llvmpipe ...)"
  bool step_by_step = false;  ///< every number was compared; false: the images are built otherwise
  std::string note;           ///< what was compared
  bool same = true;
  std::string sentence;                     ///< where they part first
  std::optional<StepRecord> first, second;  ///< the steps beside each other
  std::string second_answer;
};

struct ExplanationRecord {
  static constexpr int kVersion = 1;
  std::string scene, command;      ///< what loads it; what repeats this
  std::string version;             ///< of Plumbline
  std::string driver;              ///< GL_RENDERER and GL_VERSION
  std::string image;               ///< one line: file or bake, layout, size
  std::string shape;               ///< layout, bounds and sizes: walks through images of one shape are comparable
  std::string bounds;              ///< "sphere" or "aabb"
  std::array<std::string, 3> ray;  ///< origin, direction, t_max: hex floats separated by commas
  std::string verdict, reason;     ///< as in RayRecord
  std::string layer;               ///< that failed; empty where none did
  std::string sentence;            ///< where walk and truth part
  std::vector<std::pair<std::string, std::string>> answers;  ///< who, and what was answered
  std::vector<std::string> crossings;                        ///< exact: what the ray's line meets, a line each
  std::uint32_t truth_primitive = kNoNumber, truth_instance = kNoNumber;
  double truth_t = std::numeric_limits<double>::quiet_NaN();
  std::vector<AncestorRecord> chain;
  FaultRecord fault;
  SpaceStepRecord start;
  std::vector<StepRecord> steps;
  std::uint64_t total_steps = 0;  ///< of the walk; more than `steps` where not all are kept
  std::uint64_t skipped = 0;      ///< events that were not captured
  bool driver_agrees = true;
  SliceRecord slice;
  std::optional<ComparisonRecord> against;
};

/// The document that explanation.schema.json describes.
std::string explanation_to_json(const ExplanationRecord& record);
/// Reads the walk back (ray, image, start, steps), for comparing. Throws InputError that names the file and the place.
ExplanationRecord explanation_from_json(std::string_view text, const std::string& file);

/// A page of its own, without anything from a network.
std::string explanation_html(const ExplanationRecord& record);

/// The JSON schema of the document.
std::string_view explanation_schema();

}  // namespace plumbline
