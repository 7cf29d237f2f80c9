// SPDX-License-Identifier: MIT
// The record of a run, as plain data: what was asked, what came out, and how to ask again. Everything a report shows is
// here.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace plumbline {

/// Counts by verdict name ("agree", "tie", ...), in the order of the names. For the order of display see summary.h.
using VerdictCounts = std::map<std::string, std::uint64_t>;

/// One ray worth showing: the input as hex floats, both answers, and why the verdict fell as it did.
struct RayRecord {
  std::string verdict;
  std::uint64_t index = 0;  ///< number within its case: with the case's seed it repeats the ray
  std::string origin, direction,
      t_max;              ///< hex floats, components separated by commas: the arguments of `explain --ray`
  std::string tracer;     ///< one line: "hit 812 of instance 7 at t = 3.2000003"; no instance: in world space
  std::string reference;  ///< one line
  std::string exact;      ///< one line: what exact arithmetic says; empty where it was not asked
  std::string reason;     ///< one sentence
  double margin = 0.0;    ///< grazing rays only: units of the space where the primitive stands
  double bound = 0.0;     ///< likewise
  std::string replay;     ///< the command that repeats this ray
  std::string layer{};    ///< failing rays: "tree", "links", "bounds", "transform", "primitive arithmetic", "driver"
  std::string explanation{};  ///< the page that explains it, relative to the run's folder; empty where there is none
};

/// The colour bar of a picture whose colours are values. `colors` run evenly from `low` to `high`; empty: no bar.
struct ColorScale {
  double low = 0.0, high = 0.0;
  std::string unit;                 ///< "steps"
  std::vector<std::string> colors;  ///< "#rrggbb"
};

/// One named colour of a picture whose colours are kinds.
struct LegendEntry {
  std::string label, color;  ///< "tie", "#56b4e9"
  std::uint64_t pixels = 0;  ///< how many have it
};

/// An image file beside the report, relative to its folder. Its legend is data, so that the page can draw it as text.
struct PictureRecord {
  std::string path;           ///< "pictures/hits.camera.balls_3.steps.png"
  std::string title;          ///< "Steps per pixel"
  std::string caption;        ///< what the colours mean, with units
  int width = 0, height = 0;  ///< pixels
  ColorScale scale;
  std::vector<LegendEntry> legend;
  std::string explain;   ///< the command that explains a pixel, but for its "X,Y" at the end; empty where there is none
  std::string values{};  ///< file of its pixels' values (pixel_values.h), as `path`; empty: only colours are known
};

/// A measured figure with its unit.
struct Figure {
  std::string name, unit;
  double value = 0.0;            ///< the median where it was measured in several rounds
  double low = 0.0, high = 0.0;  ///< least and greatest of the rounds; only meaningful where rounds > 1
  int rounds = 0;                ///< 0 or 1: measured once
};

/// A small table: what a case asked and what came of each question. All rows are as long as `columns`.
struct TableRecord {
  std::string title;                 ///< "Faults and who finds them"
  std::vector<std::string> columns;  ///< headings
  std::vector<std::vector<std::string>> rows;
};

enum class CaseStatus { passed, failed, error, skipped };

struct CaseRecord {
  std::string name;     ///< dotted and stable: "hits.aimed_edges.balls_3"
  std::string feature;  ///< "hits", "driver", "bake", ...
  std::string scene;    ///< empty where the case has none
  std::string family;   ///< of rays; empty where the case has none
  std::string proves;   ///< one sentence
  std::string paper;    ///< section of the paper, "4"; empty where none
  CaseStatus status = CaseStatus::passed;
  std::string message;  ///< one line: why it failed, was skipped, or what it found
  std::uint64_t seed = 0;
  std::uint64_t rays = 0;  ///< asked for a verdict; 0 where a case traces rays without judging them
  VerdictCounts verdicts;
  double seconds = 0.0;           ///< wall clock, all in
  double trace_seconds = 0.0;     ///< of that, tracer and reference tracing
  double max_margin_ratio = 0.0;  ///< largest grazing margin over its bound; below 1 by definition
  std::string replay;             ///< the command that repeats the case
  /// All rays that the reference had wrong (up to 4096; `message` says so where there are more), and the worst few of
  /// each other verdict.
  std::vector<RayRecord> worst;
  std::vector<PictureRecord> pictures;
  std::vector<Figure> figures;
  std::vector<TableRecord> tables;
};

/// A known fault of a driver, asked for by a driver case.
struct DriverFinding {
  std::string name;    ///< "loop_cap"
  bool found = false;  ///< the driver has the fault
  std::string detail;  ///< one line: what was expected, what came
};

/// Which part of a run that was cut for many machines.
struct ShardRecord {
  int number = 0, of = 0;         ///< 2 of 5; 0 of 0: the run was not cut
  std::uint64_t whole_cases = 0;  ///< of all parts together
  std::string whole;              ///< digest of what all parts together ask, so that parts of other runs are told apart
};

struct RunRecord {
  static constexpr int kSchemaVersion = 1;  ///< of results.json (results.schema.json) and of the journal
  std::string version, commit;              ///< of Plumbline
  std::string command;                      ///< as typed
  std::uint64_t seed = 0;
  std::string started;  ///< ISO 8601, UTC
  double seconds = 0.0;
  std::string driver_renderer, driver_version;
  std::vector<DriverFinding> findings;
  std::map<std::string, std::string> libraries;  ///< name to version: Embree, CGAL, OpenImageIO, compiler
  std::string machine;                           ///< processor and number of cores
  std::uint64_t planned_cases = 0;  ///< how many cases the run set out to do; more than cases: it was cut short
  ShardRecord shard;
  std::vector<CaseRecord> cases;  ///< names are unique
};

}  // namespace plumbline
