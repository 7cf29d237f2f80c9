// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/convergence.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numbers>

#include "harness/compare_pictures.h"
#include "harness/differences.h"
#include "reports/format.h"
#include "reports/plot.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// What errors are measured by: the truth, the mean variance of a sample, and the truth's own error.
struct Measure {
  PictureMoments truth;
  double variance = 0.0;

  explicit Measure(PictureMoments moments) : truth(std::move(moments)) {
    for (const glm::dvec3& v : truth.variance) variance += (v.x + v.y + v.z) / count();
  }
  double count() const { return 3.0 * static_cast<double>(truth.mean.size()); }
  /// As a share of the variance.
  double error_of(const PictureMoments& picture) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.mean.size(); ++i) {
      const glm::dvec3 off = picture.mean[i] - truth.mean[i];
      sum += glm::dot(off, off);
    }
    return sum / (count() * variance) - 1.0 / truth.frames;
  }
};

/// Errors by level, then replicate.
using Errors = std::vector<std::vector<double>>;

Errors errors_of(PictureEngine& engine, const Measure& measure, const ConvergenceDepth& depth,
                 const std::function<void(double)>& progress) {
  Errors errors(depth.levels);
  std::uint32_t frame = 0;
  for (std::uint32_t level = 0; level < depth.levels; ++level) {
    for (std::uint32_t i = 0; i < depth.replicates; ++i, frame += 1u << level)
      errors[level].push_back(measure.error_of(engine.render(frame, 1u << level)));
    progress(static_cast<double>(2u << level) / static_cast<double>(1u << depth.levels));
  }
  return errors;
}

/// The mean of each level without the replicate `left_out`; with all where that is none of them.
std::vector<double> means_without(const Errors& errors, std::size_t left_out) {
  std::vector<double> means;
  for (const std::vector<double>& level : errors) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < level.size(); ++i)
      if (i != left_out) sum += level[i], ++count;
    means.push_back(sum / count);
  }
  return means;
}

/// Log N of the levels about their mean.
std::vector<double> centred_levels(std::size_t levels) {
  std::vector<double> x;
  for (std::size_t l = 0; l < levels; ++l)
    x.push_back(std::numbers::ln2 * (static_cast<double>(l) - 0.5 * (static_cast<double>(levels) - 1.0)));
  return x;
}

/// Of log error over log N; NaN where an error is not above zero.
double slope_of(const std::vector<double>& errors) {
  const std::vector<double> x = centred_levels(errors.size());
  double xx = 0.0, xy = 0.0;
  for (std::size_t l = 0; l < x.size(); ++l) {
    xx += x[l] * x[l];
    xy += x[l] * std::log(errors[l]);
  }
  return xy / xx;
}

/// How N times the error of one replicate grows with log N: nothing where it falls as 1/N.
double trend_of(const Errors& errors, std::size_t replicate) {
  const std::vector<double> x = centred_levels(errors.size());
  double sum = 0.0;
  for (std::size_t l = 0; l < x.size(); ++l) sum += x[l] * static_cast<double>(1u << l) * errors[l][replicate];
  return sum;
}

}  // namespace

Convergence measure_convergence(PictureEngine& tested, PictureEngine& reference, PictureEngine& truth,
                                const ConvergenceDepth& depth, const std::function<void(double)>& progress) {
  PLUMBLINE_ASSERT(depth.levels >= 3 && depth.replicates >= 8 && depth.truth_frames >= 2);
  const auto part = [&](double from, double to) {
    return [&progress, from, to](double share) {
      if (progress) progress(from + share * (to - from));
    };
  };
  const Measure measure(truth.render(0, depth.truth_frames));
  part(0.0, 0.3)(1.0);
  const Errors errors = errors_of(tested, measure, depth, part(0.3, 0.65)),
               of_reference = errors_of(reference, measure, depth, part(0.65, 1.0));
  Convergence found;
  for (std::uint32_t l = 0; l < depth.levels; ++l) found.samples.push_back(1u << l);
  found.error = means_without(errors, depth.replicates);
  found.error_of_reference = means_without(of_reference, depth.replicates);
  found.slope = slope_of(found.error);

  const auto r = static_cast<double>(depth.replicates);
  std::vector<double> slopes, trends;
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < depth.replicates; ++i) {
    slopes.push_back(slope_of(means_without(errors, i)));
    mean += slopes.back() / r;
    trends.push_back(trend_of(errors, i) - trend_of(of_reference, i));
  }
  for (const double slope : slopes) squares += (slope - mean) * (slope - mean);
  found.interval = boost::math::quantile(boost::math::students_t(r - 1.0), 0.995) * std::sqrt((r - 1.0) / r * squares);
  found.p = test_differences(trends).p;
  return found;
}

void record_convergence(const Convergence& found, const std::filesystem::path& folder, const std::string& stem,
                        CaseRecord& record) {
  if (!(found.p > kCaseLevel)) record.status = CaseStatus::failed;
  record.message = "slope " + value_text(found.slope) + " +- " + value_text(found.interval) +
                   " (99 %), expected -1; p = " + value_text(found.p) + " against the reference's own errors";
  record.figures.push_back({"slope of the error", "", found.slope, found.slope - found.interval,
                            found.slope + found.interval, static_cast<int>(found.samples.size())});
  record.figures.push_back({"p of the slope", "", found.p});
  PlotSeries measured{"measured", "#d55e00", false, found.samples, found.error};
  PlotSeries reference{"reference", "#009e73", false, found.samples, found.error_of_reference};
  PlotSeries expected{"1/N", "#0072b2", true, {}, {}};
  expected.marks = false;
  for (const double n : found.samples) {
    expected.x.push_back(n);
    expected.y.push_back(1.0 / n);
  }
  record.pictures.push_back(save_plot({"samples of each pixel",
                                       "mean square error, in variances of a sample",
                                       true,
                                       true,
                                       {measured, reference, expected}},
                                      folder, stem + ".error", "Error over samples",
                                      "Against a long reference, whose own error is subtracted."));
}

}  // namespace plumbline
