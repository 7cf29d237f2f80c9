// SPDX-License-Identifier: GPL-3.0-or-later
// Densities: are the perturbations that a renderer used distributed as SEMANTICS 7.4 says, and independent between
// dimensions, neighbouring pixels and frames? A perturbation is taken back to numbers that are uniform if it is right,
// so one set of tests serves all bodies.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "harness/catalogue.h"
#include "reports/record.h"
#include "tracer/renderer.h"

namespace plumbline {

/// Where perturbations lie: w of the time in [0, 1), the place in the pixel in [0, 1)^2 (x and y), and 7.4's bodies.
enum class Body { interval, square, cube, disc, ball };
const char* name_of(Body body);
/// How many numbers a place in it has.
int dimensions_of(Body body);

/// One perturbation for each pixel of each frame: frame by frame, row by row.
struct PerturbationGrid {
  int width = 0, height = 0;
  std::uint32_t frames = 0;
  std::vector<glm::dvec3> values;
};

/// A place as numbers in [0, 1] that are uniform and independent where it is uniform in its body: of the disc r^2 and
/// the angle, of the ball the height on its surface, the angle and r^3. NaN where it lies outside of the body by more
/// than `rounding`, a share of its size.
glm::dvec3 uniform_numbers(Body body, const glm::dvec3& place, double rounding);

struct DensityTest {
  std::string name;   ///< "r^2: Kolmogorov-Smirnov"
  double p = 1.0;     ///< of this test alone
  std::string found;  ///< "D = 0.0012"
};

struct DensityResult {
  std::size_t values = 0;
  std::vector<DensityTest> tests;
  std::vector<std::vector<double>> away;  ///< for each dimension sqrt(n) (F_n(u) - u) at u = 1/64, 2/64, ...
  double seen = 0.0;                      ///< the least error of a distribution function that is always an alarm
  double p() const;                       ///< the smallest, times their number
};

/// Each dimension alone (Kolmogorov-Smirnov, Anderson-Darling, chi-square of 64 classes), pairs of dimensions and all
/// of them (chi-square of cells), and pairs of the same dimension in neighbouring columns, rows and frames, and after
/// two and 64 frames (chi-square of 8 x 8 cells and correlation). At least 4096 values.
DensityResult test_density(Body body, const PerturbationGrid& grid, double rounding, double level);

/// Adds figures, the table of tests and the plot; fails where p is at most `level`.
void record_density(const DensityResult& result, Body body, double level, const std::filesystem::path& folder,
                    const std::string& stem, CaseRecord& record);

/// What takes perturbations from a renderer.
struct PerturbationSource {
  std::string name;       ///< in case names: "reference"
  double rounding = 0.0;  ///< of its perturbations, as a share of the body's size
  /// For "aa", "dof", "soft_shadow", "glossy" (the primary ray's), "motion_blur" (one pixel).
  std::function<PerturbationGrid(CaseContext&, const std::string& effect, Effects::Model, std::uint64_t seed, int width,
                                 int height, std::uint32_t frames)>
      take;
};

/// `drt.densities.<source>.<effect>.<model>`.
std::vector<Case> density_cases(const PerturbationSource& source);
/// The reference's own: its generator and its formulas.
PerturbationSource reference_perturbations();
/// The tracer's: what its shaders have used in a picture, with one source of random numbers.
PerturbationSource tracer_perturbations(RandomKind random, const std::vector<ShaderPatch>& patches = {});

}  // namespace plumbline
