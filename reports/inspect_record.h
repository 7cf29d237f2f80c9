// SPDX-License-Identifier: MIT
// The record of an inspected geometry image, as plain data: its trees, what they must cost and what rays did there.
// Everything that `inspect` prints and its page shows is here.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "reports/record.h"
#include "scenes/scene.h"

namespace plumbline {

/// Of a few numbers or many.
struct SpreadRecord {
  std::uint64_t count = 0;  ///< 0: there are none, and nothing else counts
  double mean = 0.0, min = 0.0, median = 0.0, p99 = 0.0, max = 0.0;
};

/// How many have each whole number: counts[i] of `first` + i * `width` up to before the next.
struct HistogramRecord {
  std::string name, unit;  ///< "leaves by depth", "nodes"
  std::uint64_t first = 0, width = 1;
  std::vector<std::uint64_t> counts;
};

/// A named share of a whole.
struct ShareRecord {
  std::string name;
  std::uint64_t count = 0;
};

struct InspectedRegionRecord {
  std::string name;         ///< "world", "behind node 3 (walker/leg) and 7 others"
  std::uint64_t shown = 1;  ///< transforms that lead here; 1 for the world
  std::uint64_t nodes = 0, leaves = 0, transforms = 0, primitives = 0, depth = 0, texels = 0;
  double visits = 0.0, tests = 0.0;  ///< that a random line through its space's ball costs, if nothing stops it
};

/// A node of the first copy of its region. Coordinates and radii in the units of the region's space.
struct InspectedNodeRecord {
  std::uint32_t region = 0, number = 0;
  int x = 0, y = 0;              ///< of its upper texel
  std::uint32_t parent = kNone;  ///< into InspectedBake::nodes; kNone: a root of its region
  std::uint32_t depth = 1;
  std::uint32_t children = 0;  ///< all of them, also those that are not kept
  bool is_leaf = false;
  std::uint32_t transform = kNone;                ///< of a leaf: the scene's node that it leads into
  std::uint32_t behind = kNone;                   ///< likewise: the region there
  std::uint32_t primitives = 0;                   ///< below it in its region
  std::array<double, 3> center{};                 ///< of the ball or the box
  std::array<double, 3> half{};                   ///< of a box: half its sides
  double radius = 0.0;                            ///< of the ball; of a box: half its diagonal
  double chance = 0.0;                            ///< that a random line through the space's ball meets it
  double overlap = 0.0;                           ///< of its children, over its volume; NaN: fewer than two
  double slack = 0.0;                             ///< 0: not known
  std::uint64_t visits = 0, hits = 0, tests = 0;  ///< measured, all rays together
  double cost = 0.0;                              ///< measured, in sphere tests
  double other_visits = 0.0;  ///< of its twin in the image that this one is compared with; NaN: there is none
};

/// A ray that walked long.
struct InspectedRayRecord {
  std::string origin, direction;  ///< hex floats
  std::string where;              ///< "pixel 120, 44", "line 812"
  std::uint64_t steps = 0, tests = 0, transforms = 0;
  std::string answer;  ///< "hit 812 at t = 3.2", "miss"
  std::string replay;  ///< the command that explains it; empty where no scene is known
};

/// Rays of one kind, traced through the image.
struct InspectedRays {
  std::string name;  ///< "camera", "lines"
  std::string what;  ///< one sentence
  std::uint64_t count = 0, hits = 0;
  SpreadRecord steps, tests;                          ///< per ray
  double expected_steps = 0.0, expected_tests = 0.0;  ///< by r^2, if nothing stopped them; NaN: not known
  HistogramRecord histogram;                          ///< of steps
  std::vector<InspectedRayRecord> longest;
};

struct InspectedBake {
  std::string name;                                          ///< short, to tell two apart: "compact_sphere_octant"
  std::string source;                                        ///< the scene or file
  std::vector<std::pair<std::string, std::string>> options;  ///< name and value
  int width = 0, height = 0;                                 ///< texels
  double unit = 1.0;                                         ///< of the world space's numbers here, in world units
  std::vector<std::string> faults;                           ///< what breaks the format
  std::uint64_t fault_count = 0;
  std::uint64_t nodes = 0, leaves = 0, primitives = 0, transforms = 0, depth = 0, copies = 1;
  double expected_steps = 0.0, expected_tests = 0.0, expected_transforms = 0.0;  ///< of a random line
  SpreadRecord slack, overlap;
  double overlap_met = 0.0;         ///< the overlap at a node that a random line hits, in the mean
  std::vector<ShareRecord> memory;  ///< texels by kind
  std::vector<HistogramRecord> histograms;
  std::vector<InspectedRegionRecord> regions;
  std::vector<InspectedRays> rays;
  /// Parents before children. All, or where there are many those of the upper levels: `kept_depth` says how deep (0:
  /// all).
  std::vector<InspectedNodeRecord> outline;
  std::uint64_t kept_depth = 0;
  std::vector<InspectedNodeRecord> costliest;  ///< of all nodes; their parents are numbers within the region
  std::vector<std::uint64_t> visits_by_depth;  ///< measured, all rays: [d] at depth d of the region
  std::vector<PictureRecord> pictures;
  double bake_seconds = 0.0;  ///< 0: it was read from a file
  double statistics_seconds = 0.0, trace_seconds = 0.0;
};

struct InspectRecord {
  static constexpr int kSchemaVersion = 1;  ///< of inspect.json
  std::string version, commit;              ///< of Plumbline
  std::string command;                      ///< as typed
  std::string driver;
  std::string camera;                ///< whose it is: one sentence
  std::vector<InspectedBake> bakes;  ///< one, or two that are compared
  bool are_alike = false;            ///< of two: the same trees, so that their nodes are compared one by one
};

}  // namespace plumbline
