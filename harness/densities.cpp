// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/densities.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/compare_pictures.h"
#include "harness/distributions.h"
#include "reports/format.h"
#include "reports/plot.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr std::size_t kClasses = 64;  ///< of one number alone
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// `value` where it lies in [0, 1] or beyond it by what rounding may do, then at the end.
double within(double value, double rounding) {
  if (!(value >= -rounding && value <= 1.0 + rounding)) return kNaN;
  return std::clamp(value, 0.0, 1.0);
}

double turns(double x, double y) {
  const double angle = std::atan2(y, x) / (2.0 * std::numbers::pi);
  return angle < 0.0 ? angle + 1.0 : angle;
}

std::vector<std::string> number_names(Body body) {
  switch (body) {
    case Body::interval:
      return {"w"};
    case Body::square:
      return {"a", "b"};
    case Body::cube:
      return {"x", "y", "z"};
    case Body::disc:
      return {"r^2", "angle"};
    case Body::ball:
      return {"height", "angle", "r^3"};
  }
  return {};
}

std::size_t class_of(double u, std::size_t classes) {
  return std::min(classes - 1, static_cast<std::size_t>(u * static_cast<double>(classes)));
}

/// Chi-square of numbers taken together, `classes` of each.
double joint_p(const std::vector<const std::vector<double>*>& numbers, std::size_t count, std::size_t classes) {
  std::size_t cells = 1;
  for (std::size_t i = 0; i < numbers.size(); ++i) cells *= classes;
  std::vector<std::uint64_t> counts(cells, 0);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t cell = 0;
    for (const auto* u : numbers) {
      if (!std::isfinite((*u)[i])) return 0.0;
      cell = cell * classes + class_of((*u)[i], classes);
    }
    ++counts[cell];
  }
  const std::vector<double> expected(cells, static_cast<double>(count) / static_cast<double>(cells));
  return chi_square_p(counts, expected);
}

class Tester {
 public:
  Tester(Body body, const PerturbationGrid& grid, double rounding, double level) : grid_(grid), level_(level) {
    PLUMBLINE_ASSERT(grid.width > 0 && grid.height > 0 &&
                     grid.values.size() ==
                         static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height) * grid.frames);
    PLUMBLINE_ASSERT(grid.values.size() >= 4096);
    names_ = number_names(body);
    numbers_.resize(names_.size());
    for (const glm::dvec3& place : grid.values) {
      const glm::dvec3 u = uniform_numbers(body, place, rounding);
      for (std::size_t d = 0; d < names_.size(); ++d) numbers_[d].push_back(u[static_cast<int>(d)]);
    }
  }

  DensityResult result() {
    result_.values = grid_.values.size();
    for (std::size_t d = 0; d < names_.size(); ++d) alone(d);
    together();
    const auto w = static_cast<std::size_t>(grid_.width), h = static_cast<std::size_t>(grid_.height);
    for (std::size_t d = 0; d < names_.size(); ++d) {
      if (w > 1) lagged(d, "next column", 1);
      if (h > 1) lagged(d, "next row", w);
      for (const std::uint32_t frames : {1u, 2u, 64u})
        if (grid_.frames > frames) lagged(d, counted(frames, "frame") + " later", w * h * frames);
    }
    // The level of one test, as a distance: 2 exp(-2 n D^2) = level.
    const double level = level_ / static_cast<double>(result_.tests.size());
    result_.seen = std::sqrt(std::log(2.0 / level) / (2.0 * static_cast<double>(result_.values)));
    return std::move(result_);
  }

 private:
  void add(const std::string& name, double p, const std::string& found) { result_.tests.push_back({name, p, found}); }

  void alone(std::size_t d) {
    const std::vector<double>& u = numbers_[d];
    const UniformTest test = test_uniform(u);
    const auto outside =
        static_cast<std::uint64_t>(std::count_if(u.begin(), u.end(), [](double v) { return std::isnan(v); }));
    const std::string lost = outside > 0 ? counted(outside, "place") + " outside" : "";
    add(names_[d] + ": Kolmogorov-Smirnov", test.kolmogorov_p,
        lost.empty() ? "D = " + value_text(test.kolmogorov) : lost);
    add(names_[d] + ": Anderson-Darling", test.anderson_p, lost.empty() ? "A^2 = " + value_text(test.anderson) : lost);
    add(names_[d] + ": chi-square", joint_p({&u}, u.size(), kClasses), std::to_string(kClasses) + " classes");
    std::vector<double> away(kClasses - 1, 0.0);
    for (const double v : u)
      if (std::isfinite(v))
        for (std::size_t k = class_of(v, kClasses); k + 1 < kClasses; ++k) away[k] += 1.0;
    const auto n = static_cast<double>(u.size());
    for (std::size_t k = 0; k + 1 < kClasses; ++k)
      away[k] = std::sqrt(n) * (away[k] / n - static_cast<double>(k + 1) / kClasses);
    result_.away.push_back(std::move(away));
  }

  void together() {
    const std::size_t n = grid_.values.size();
    for (std::size_t d = 0; d < names_.size(); ++d)
      for (std::size_t e = d + 1; e < names_.size(); ++e)
        add(names_[d] + " with " + names_[e], joint_p({&numbers_[d], &numbers_[e]}, n, 16), "16 x 16 cells");
    if (names_.size() == 3)
      add("all three", joint_p({&numbers_[0], &numbers_[1], &numbers_[2]}, n, 8), "8 x 8 x 8 cells");
  }

  /// Of every two values one is the first of a pair, in the order of a chessboard: no value is in two pairs, so pairs
  /// are independent, and neighbours on either side are met.
  void lagged(std::size_t d, const std::string& name, std::size_t step) {
    const auto w = static_cast<std::size_t>(grid_.width), h = static_cast<std::size_t>(grid_.height);
    const std::size_t frames = std::max<std::size_t>(1, step / (w * h));
    const bool across = step == 1 && w > 1, down = !across && step < w * h;
    std::vector<double> a, b;
    for (std::size_t i = 0; i + step < numbers_[d].size(); ++i) {
      const std::size_t x = i % w, y = i / w % h, f = i / (w * h);
      if ((x + y + f / frames) % 2 == 1 || (across && x + 1 == w) || (down && y + 1 == h)) continue;
      a.push_back(numbers_[d][i]);
      b.push_back(numbers_[d][i + step]);
    }
    if (a.size() < 64 * 5) return;
    add(names_[d] + ", " + name + ": chi-square", joint_p({&a, &b}, a.size(), 8), "8 x 8 cells");
    add(names_[d] + ", " + name + ": correlation", correlation_p(a, b), "");
  }

  const PerturbationGrid& grid_;
  const double level_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> numbers_;
  DensityResult result_;
};

}  // namespace

const char* name_of(Body body) {
  switch (body) {
    case Body::interval:
      return "interval";
    case Body::square:
      return "square";
    case Body::cube:
      return "cube";
    case Body::disc:
      return "disc";
    case Body::ball:
      return "ball";
  }
  return "";
}

int dimensions_of(Body body) { return static_cast<int>(number_names(body).size()); }

glm::dvec3 uniform_numbers(Body body, const glm::dvec3& p, double rounding) {
  switch (body) {
    case Body::interval:
      return {within(p.x, rounding), 0.0, 0.0};
    case Body::square:
      return {within(p.x, rounding), within(p.y, rounding), 0.0};
    case Body::cube: {
      const glm::dvec3 u = 0.5 * (p + 1.0);
      return {within(u.x, rounding), within(u.y, rounding), within(u.z, rounding)};
    }
    case Body::disc: {
      const double r2 = std::fabs(p.z) <= rounding ? within(p.x * p.x + p.y * p.y, 2.0 * rounding) : kNaN;
      return {r2, std::isnan(r2) ? kNaN : turns(p.x, p.y), 0.0};
    }
    case Body::ball: {
      const double r = glm::length(p), cube = within(r * r * r, 3.0 * rounding);
      if (std::isnan(cube)) return glm::dvec3(kNaN);
      return {r > 0.0 ? 0.5 * (1.0 - p.z / r) : 0.5, turns(p.x, p.y), cube};
    }
  }
  return glm::dvec3(kNaN);
}

double DensityResult::p() const {
  double least = 1.0;
  for (const DensityTest& test : tests) least = std::min(least, std::isnan(test.p) ? 0.0 : test.p);
  return std::min(1.0, least * static_cast<double>(tests.size()));
}

DensityResult test_density(Body body, const PerturbationGrid& grid, double rounding, double level) {
  return Tester(body, grid, rounding, level).result();
}

void record_density(const DensityResult& result, Body body, double level, const std::filesystem::path& folder,
                    const std::string& stem, CaseRecord& record) {
  if (!(result.p() > level)) record.status = CaseStatus::failed;
  const auto worst = std::min_element(result.tests.begin(), result.tests.end(),
                                      [](const DensityTest& a, const DensityTest& b) { return a.p < b.p; });
  record.message = (result.p() > level ? "as it should be: least p "
                                       : "not uniform in its " + std::string(name_of(body)) + ": p = ") +
                   value_text(worst->p) + " (" + worst->name + (worst->found.empty() ? "" : ", " + worst->found) +
                   ") of " + counted(result.tests.size(), "test");
  record.figures.push_back({"perturbations", "", static_cast<double>(result.values)});
  record.figures.push_back({"p of the density", "", result.p()});
  record.figures.push_back({"error of a distribution function that would be seen", "", result.seen});
  TableRecord table{"Tests of the " + std::string(name_of(body)), {"test", "p", "found"}, {}};
  for (const DensityTest& test : result.tests) table.rows.push_back({test.name, value_text(test.p), test.found});
  record.tables.push_back(std::move(table));
  const std::vector<std::string> names = number_names(body);
  constexpr const char* kColors[]{"#d55e00", "#0072b2", "#009e73"};
  Plot plot{"number u that should be uniform", "sqrt(n) (share found below u - u)", false, false, {}};
  for (std::size_t d = 0; d < result.away.size(); ++d) {
    PlotSeries series{names[d], kColors[d], false, {0.0}, {0.0}, false};
    for (std::size_t k = 0; k < result.away[d].size(); ++k) {
      series.x.push_back(static_cast<double>(k + 1) / kClasses);
      series.y.push_back(result.away[d][k]);
    }
    series.x.push_back(1.0), series.y.push_back(0.0);
    plot.series.push_back(std::move(series));
  }
  record.pictures.push_back(
      save_plot(plot, folder, stem + ".away", "Away from uniform",
                "A bridge between 0 and 1 that rarely leaves -1.6 to 1.6 where the density is right."));
}

}  // namespace plumbline
