// SPDX-License-Identifier: MIT
// See example_run.h.
#include "reports/example_run.h"

#include <stdlib.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "reports/explanation.h"
#include "reports/files.h"
#include "reports/picture.h"
#include "scenes/random.h"
#include "scenes/scene.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFamilies = {"camera",     "secondary",       "random_chords",  "aimed_vertices", "aimed_edges",
                                  "near_edges", "sphere_tangents", "in_plane",       "along_axes",     "origins_inside",
                                  "on_surface", "far_origins",     "denormal_scale", "finite_tmax",    "not_a_number"};
constexpr std::array kScenes = {"balls_3",     "balls_4",         "mount_6",   "tetra_6",     "rings_7",
                                "gears_4",     "creature",        "bunny",     "spot",        "building",
                                "cornell_box", "cornell_spheres", "spd_balls", "spd_gears",   "spd_mount",
                                "spd_rings",   "spd_tetra",       "spd_tree",  "spd_lattice", "shells"};

std::string hex_floats(Random& random, double scale) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%a", static_cast<double>(static_cast<float>(random.uniform(-scale, scale))));
    text += (i ? "," : "") + std::string(buffer);
  }
  return text;
}

RayRecord example_ray(const std::string& verdict, const std::string& scene, Random& random) {
  const std::uint32_t near = random.below(70000), far = random.below(70000);
  const double t = random.uniform(0.5, 9.0);
  RayRecord ray;
  ray.verdict = verdict;
  ray.index = random.below(1u << 20);
  ray.origin = hex_floats(random, 4.0);
  ray.direction = hex_floats(random, 1.0);
  ray.t_max = "inf";
  const auto hit = [&](std::uint32_t primitive, double at) {
    char text[80];
    std::snprintf(text, sizeof text, "hit %u at t = %.9g", primitive, at);
    return std::string(text);
  };
  ray.tracer = verdict == "leak" ? "miss" : hit(near, t);
  ray.reference = verdict == "reference_wrong" ? "miss" : hit(verdict == "agree" ? near : far, t * (1.0 + 1e-7));
  ray.exact = "nearest is " + std::to_string(verdict == "tracer_wrong" ? far : near);
  if (verdict == "grazing") {
    ray.bound = random.uniform(1e-7, 3e-7);
    ray.margin = ray.bound * random.uniform();
    ray.reason = "The ray passes the edge (corner 0, corner 1) of primitive " + std::to_string(near) +
                 " by less than 32 bits resolve.";
  } else if (verdict == "tie") {
    ray.reason =
        "Primitives " + std::to_string(near) + " and " + std::to_string(far) + " share the edge that the ray meets.";
  } else if (verdict == "leak") {
    ray.reason = "The ray meets the shared edge of " + std::to_string(near) + " and " + std::to_string(far) +
                 "; the tracer hit neither.";
  } else {
    ray.reason = "Exact arithmetic finds primitive " + std::to_string(near) + " at the least t.";
  }
  if (verdict == "leak" || verdict == "tracer_wrong") {
    ray.layer = verdict == "leak" ? "primitive arithmetic" : "bounds";
    ray.explanation = "explanations/" + scene + "-" + std::to_string(ray.index) + ".html";
  }
  ray.replay = "plumbline explain " + scene + " --ray " + ray.origin + "," + ray.direction;
  return ray;
}

CaseRecord example_case(const std::string& family, const std::string& scene, std::size_t row, std::size_t column,
                        const ExampleOptions& options) {
  Random random(7, name_hash(family), name_hash(scene));
  CaseRecord record;
  record.name = "hits." + family + "." + scene;
  record.feature = "hits";
  record.scene = scene;
  record.family = family;
  record.proves = "The production tracer finds what exact arithmetic finds for rays of the family " + family + ".";
  record.paper = "3.1";
  record.seed = random.bits();
  record.rays = 76500;
  record.seconds = random.uniform(0.4, 2.4);
  record.trace_seconds = 0.81 * record.seconds;
  record.replay = "plumbline run " + record.name + " --seed " + std::to_string(record.seed);
  const bool edges = family.find("edges") != std::string::npos || family.find("vertices") != std::string::npos;
  record.verdicts["tie"] = edges ? 4000 + random.below(9000) : random.below(3);
  record.verdicts["grazing"] = edges ? 200 + random.below(900) : random.below(6);
  if (family == "not_a_number") record.verdicts["undefined"] = 9000 + random.below(900);
  if ((row + 2 * column) % 17 == 3) record.verdicts["reference_wrong"] = options.rays_per_case / 2 + random.below(4);
  record.max_margin_ratio = random.uniform(0.3, 0.97);
  if (options.failing && row == 2 && column == 1) {
    record.status = CaseStatus::failed;
    record.verdicts["tracer_wrong"] = 3;
    record.message =
        "3 rays are tracer_wrong; the brute-force layer agrees with them: the tree lost nothing, the arithmetic did.";
  }
  if (options.failing && row == 4 && column == 3) {
    record.status = CaseStatus::failed;
    record.verdicts["leak"] = 11;
    record.message = "11 rays slipped through shared edges of a closed surface.";
  }
  if (options.failing && row == 1 && column == 2) {
    record.status = CaseStatus::error;
    record.rays = 0;
    record.verdicts.clear();
    record.message = "The geometry image needs 32,768 texels a side, the driver allows 16,384.";
  }
  if (row == 3 && column == 0) {
    record.status = CaseStatus::skipped;
    record.rays = 0;
    record.verdicts.clear();
    record.message = "The scene is not among the data on this machine.";
  }
  std::uint64_t judged = 0;
  for (const auto& [name, count] : record.verdicts) judged += count;
  if (record.rays) record.verdicts["agree"] = record.rays - judged;
  std::vector<std::string> names;
  for (const auto& [name, count] : record.verdicts)
    if (count && name != "agree") names.push_back(name);
  for (std::size_t i = 0; i < options.rays_per_case && !names.empty(); ++i)
    record.worst.push_back(example_ray(names[i % names.size()], scene, random));
  return record;
}

/// What both renderers made of the same discs, and the difference: the second disc is darker in one of them.
void add_example_pair(CaseRecord& record, const fs::path& folder) {
  constexpr int kWidth = 64, kHeight = 48;
  std::vector<glm::dvec3> tracer, reference;
  std::vector<float> difference;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      glm::dvec3 color(0.02, 0.05, 0.12);
      double share = 1.0;
      for (int i = 0; i < 4; ++i) {
        const double dx = x - (10.0 + 14.0 * i), dy = y - (12.0 + 7.0 * i), r2 = 90.0, d2 = dx * dx + dy * dy;
        if (d2 > r2) continue;
        color = glm::dvec3(i == 0, i == 1 ? 1.2 : 0.4, 0.3 * i) * std::sqrt(1.0 - d2 / r2);
        share = i == 1 ? 0.98 : 1.0;
      }
      reference.push_back(color);
      tracer.push_back(share * color);
      const glm::dvec3 off = tracer.back() - color;
      difference.push_back(static_cast<float>((off.x + off.y + off.z) / 3.0));
    }
  }
  record.pictures.push_back(save_picture(paint_colors(tracer, kWidth, kHeight), folder, record.name + ".tracer",
                                         "Tracer", "Mean of 64 samples a pixel."));
  record.pictures.push_back(save_picture(paint_colors(reference, kWidth, kHeight), folder, record.name + ".truth",
                                         "Reference", "Mean of 64 samples a pixel."));
  record.pictures.push_back(save_picture(paint_signed(difference, kWidth, kHeight, "linear colour", 0.02), folder,
                                         record.name + ".difference", "Tracer less reference",
                                         "Orange where the tracer is brighter, blue where it is darker."));
}

std::string named(const auto& names, std::size_t i, const char* rest) {
  return i < names.size() ? names[i] : rest + std::to_string(i);
}

}  // namespace

const char* const kNastyText =
    "</script><b a=\"1\" c='2'>&amp; \x01\x1b[31m \xff\xc0\x80 \xed\xa0\x80 \xef\xbf\xbf {{main}} ]]> -- `|` "
    "\xc3\xa9\n\ttail";

RunRecord example_run(const ExampleOptions& options) {
  RunRecord run;
  run.version = "0.1.0";
  run.commit = "b9c5e92d4f0a1c33";
  run.command = "plumbline nightly --budget 20m";
  run.seed = 17446744073709551557ull;
  run.started = "2026-11-22T03:00:00Z";
  run.seconds = 552.4;
  run.driver_renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
  run.driver_version = "4.5 (Core Profile) Mesa 22.3.6";
  run.findings = {{"loop_cap", true, "expected 200,000 iterations, the loop ended after 65,535 without a word"},
                  {"clobbered_value", true, "expected 17 in all pixels, 2,114 of 65,536 hold another lane's value"},
                  {"float_round_trip", false, "all 4,096 patterns came back bit for bit, denormals included"},
                  {"product_fused", false, "a * b - c * d is antisymmetric on 65,536 pairs"}};
  run.libraries = {{"Embree", "3.13.5"}, {"CGAL", "5.5.1"}, {"OpenImageIO", "2.4.7"}, {"gcc", "12.2.0"}};
  run.machine = "made-up processor, 2 cores";
  for (const DriverFinding& finding : run.findings) {
    CaseRecord record;
    record.name = "driver." + finding.name;
    record.feature = "driver";
    record.proves = "Whether the driver computes a known idiom right.";
    record.message = (finding.found ? "The driver has this fault: " : "The driver is right: ") + finding.detail;
    record.seconds = 0.02;
    record.replay = "plumbline run " + record.name;
    run.cases.push_back(record);
  }
  CaseRecord bench;
  bench.name = "bench.primary";
  bench.feature = "bench";
  bench.scene = "bunny";
  bench.proves = "How fast the tracer is beside the reference.";
  bench.seconds = 31.0;
  bench.figures = {{"primary_vs_embree.bunny", "1", 0.5512, 0.5391, 0.5604, 7},
                   {"bake_seconds.1e6", "s", 11.37, 11.02, 11.9, 5},
                   {"rays_per_second.bunny", "rays/s", 5123456.0, 0.0, 0.0, 1}};
  bench.tables = {{"Bakes by size", {"triangles", "seconds"}, {{"10,000", "0.02"}, {"<1,000,000>", "3.1"}}}};
  run.cases.push_back(bench);
  for (std::size_t row = 0; row < options.families; ++row)
    for (std::size_t column = 0; column < options.scenes; ++column)
      run.cases.push_back(
          example_case(named(kFamilies, row, "family_"), named(kScenes, column, "scene_"), row, column, options));
  run.planned_cases = run.cases.size();
  return run;
}

void add_example_pictures(RunRecord& run, const fs::path& folder) {
  constexpr int kSize = 192;
  for (CaseRecord& record : run.cases) {
    if (record.family != "camera") continue;
    // Discs of hashed places and sizes stand in for a scene.
    std::vector<float> steps(kSize * kSize), brightness(kSize * kSize);
    std::vector<std::uint32_t> primitives(kSize * kSize, kNone);
    std::vector<std::uint8_t> verdicts(kSize * kSize, 0);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const auto at = static_cast<std::size_t>(y * kSize + x);
        double depth = -1e9, near = 1e9;
        for (std::uint32_t i = 0; i < 60; ++i) {
          Random random(11, name_hash(record.scene), i);
          const double cx = random.uniform(0.1, 0.9), cy = random.uniform(0.1, 0.9), r = random.uniform(0.02, 0.16);
          const double dx = (x + 0.5) / kSize - cx, dy = (y + 0.5) / kSize - cy, inside = r * r - dx * dx - dy * dy;
          near = std::min(near, std::fabs(std::sqrt(dx * dx + dy * dy) - r));
          if (inside <= 0.0 || std::sqrt(inside) <= depth) continue;
          depth = std::sqrt(inside);
          primitives[at] = i;
          brightness[at] = static_cast<float>(depth / r);
        }
        steps[at] = primitives[at] == kNone && near > 0.1 ? std::nanf("")
                                                          : static_cast<float>(8.0 + 90.0 * std::exp(-40.0 * near));
      }
    }
    Random random(13, name_hash(record.scene), 0);
    for (int i = 0; i < 30; ++i) verdicts[random.below(kSize * kSize)] = static_cast<std::uint8_t>(1 + random.below(3));
    const std::vector<std::string> names = {"agree", "tie", "grazing", "tracer_wrong"};
    record.pictures = {
        save_picture(paint_primitives(primitives, brightness, kSize, kSize), folder, record.name + ".hits", "Hit map",
                     "The primitive that each pixel's ray hits."),
        save_picture(paint_values(steps, kSize, kSize, "steps"), folder, record.name + ".steps", "Steps per pixel",
                     "Cells visited by each pixel's ray."),
        save_picture(paint_verdicts(verdicts, names, brightness, kSize, kSize), folder, record.name + ".verdicts",
                     "Disagreements", "What does not agree is drawn as a dot of 5 pixels.")};
    add_example_pair(record, folder);
    for (PictureRecord& picture : record.pictures) picture.explain = "plumbline explain " + record.scene + " --pixel";
  }
}

void add_example_explanations(const RunRecord& run, const fs::path& folder) {
  for (const CaseRecord& record : run.cases) {
    for (const RayRecord& ray : record.worst) {
      if (ray.explanation.empty()) continue;
      ExplanationRecord page;
      page.scene = record.scene, page.command = ray.replay, page.version = run.version;
      page.driver = run.driver_renderer, page.image = "baked now, compact, 512 x 512";
      page.ray = {ray.origin, ray.direction, ray.t_max};
      page.verdict = ray.verdict, page.reason = ray.reason, page.layer = ray.layer;
      page.sentence =
          "The sphere of node 57 at cell (114, 12) rejected the ray; primitive 3 below it is hit at t = 2.5.";
      page.answers = {{"tracer", ray.tracer}, {"reference", ray.reference}, {"exact", ray.exact}};
      page.crossings = {"triangle 3 at t = 2.5"};
      page.truth_primitive = 3, page.truth_t = 2.5;
      for (std::uint32_t i = 0; i < 3; ++i) {
        StepRecord step;
        step.number = i + 1, step.cell = 100 + i, step.x = 100 + static_cast<int>(i), step.node = 55 + i;
        step.test = i == 2 ? "missed" : "hit", step.reason = i == 2 ? "miss" : "entered";
        step.distance2 = 0.25f, step.radius2 = i == 2 ? 0.2499f : 4.0f, step.foot = 2.5f;
        step.on_chain = step.notable = true, step.ended = i == 2, step.next = i == 2 ? kNoNumber : 101 + i;
        page.steps.push_back(step);
        page.chain.push_back({kNoNumber, step.cell, step.node, step.x, 0, kNoNumber, i});
        page.slice.shapes.push_back({i == 2 ? "fault" : "entered",
                                     "node " + std::to_string(55 + i),
                                     i,
                                     true,
                                     2.5,
                                     0.4 - 0.1 * i,
                                     2.0 - 0.7 * i,
                                     2.0 - 0.7 * i,
                                     0.0,
                                     {}});
      }
      page.slice.shapes.push_back({"truth", "primitive 3", kNoNumber, false, 0, 0, 0, 0, 0, {{2.4, -0.3}, {2.6, 0.3}}});
      page.slice.length = 1.0;
      page.slice.marks = {{"origin", "origin", 0.0}, {"truth", "primitive 3 at t = 2.5", 2.5}};
      page.total_steps = 3;
      page.fault = {"bounds", 2, kNoNumber, 102, 57, kNoNumber, 102, 0, 3.1e-4, "no"};
      write_text(folder / ray.explanation, explanation_html(page));
    }
  }
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "plumbline-reports-XXXXXX").string();
  path = ::mkdtemp(name.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path, error);
}

}  // namespace plumbline
