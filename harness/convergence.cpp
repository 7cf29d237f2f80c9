// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/convergence.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "harness/compare_pictures.h"
#include "reports/format.h"
#include "reports/plot.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

double mean_of(const std::vector<glm::dvec3>& values) {
  double sum = 0.0;
  for (const glm::dvec3& v : values) sum += v.x + v.y + v.z;
  return sum / (3.0 * static_cast<double>(values.size()));
}

}  // namespace

Convergence measure_convergence(PictureEngine& tested, PictureEngine& truth, const ConvergenceDepth& depth,
                                const std::function<void(double)>& progress) {
  PLUMBLINE_ASSERT(depth.levels >= 3 && depth.replicates >= 4 && depth.truth_frames >= 2);
  const PictureMoments right = truth.render(0, depth.truth_frames);
  const double error_of_truth = mean_of(right.variance) / depth.truth_frames;
  if (progress) progress(0.4);
  Convergence found;
  std::uint32_t frame = 0;
  const auto r = static_cast<double>(depth.replicates);
  for (std::uint32_t level = 0; level < depth.levels; ++level) {
    const std::uint32_t n = 1u << level;
    std::vector<double> errors;
    for (std::uint32_t i = 0; i < depth.replicates; ++i, frame += n) {
      const PictureMoments picture = tested.render(frame, n);
      std::vector<glm::dvec3> squares;
      for (std::size_t p = 0; p < picture.mean.size(); ++p)
        squares.push_back((picture.mean[p] - right.mean[p]) * (picture.mean[p] - right.mean[p]));
      errors.push_back(mean_of(squares) - error_of_truth);
    }
    double mean = 0.0, squares = 0.0;
    for (const double e : errors) mean += e / r;
    for (const double e : errors) squares += (e - mean) * (e - mean);
    found.samples.push_back(n);
    found.error.push_back(mean);
    found.deviation.push_back(std::sqrt(squares / (r * (r - 1.0))) / mean);
    if (progress) progress(0.4 + 0.6 * (level + 1) / depth.levels);
  }
  fit_slope(found, (r - 1.0) * depth.levels);
  return found;
}

void fit_slope(Convergence& found, double freedom) {
  // The errors' relative deviation is nearly the same at all levels (each is a sum over the same pixels), so it is
  // pooled; the replicates of one level alone would say it badly.
  double variance = 0.0, mean_x = 0.0;
  const auto levels = static_cast<double>(found.samples.size());
  bool usable = true;
  for (std::size_t i = 0; i < found.samples.size(); ++i) {
    usable = usable && found.error[i] > 0.0 && std::isfinite(found.deviation[i]);
    variance += found.deviation[i] * found.deviation[i] / levels;
    mean_x += std::log(found.samples[i]) / levels;
  }
  if (!usable) {  // no noise at all, or an error that is none
    found.slope = found.interval = std::numeric_limits<double>::quiet_NaN();
    found.p = 0.0;
    return;
  }
  double xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < found.samples.size(); ++i) {
    const double x = std::log(found.samples[i]) - mean_x;
    xx += x * x;
    xy += x * std::log(found.error[i]);
  }
  found.slope = xy / xx;
  const double deviation = std::sqrt(variance / xx);
  const boost::math::students_t student(freedom);
  found.interval = boost::math::quantile(student, 0.995) * deviation;
  const double t = std::fabs(found.slope + 1.0) / deviation;
  found.p = std::isfinite(t) ? 2.0 * boost::math::cdf(boost::math::complement(student, t)) : 0.0;
}

void record_convergence(const Convergence& found, const std::filesystem::path& folder, const std::string& stem,
                        CaseRecord& record) {
  if (!(found.p > kCaseLevel)) record.status = CaseStatus::failed;
  record.message = "slope " + value_text(found.slope) + " +- " + value_text(found.interval) +
                   " (99 %), expected -1 (p = " + value_text(found.p) + ")";
  record.figures.push_back({"slope of the error", "", found.slope, found.slope - found.interval,
                            found.slope + found.interval, static_cast<int>(found.samples.size())});
  record.figures.push_back({"p of the slope", "", found.p});
  PlotSeries measured{"measured", "#d55e00", false, found.samples, found.error};
  PlotSeries expected{"1/N", "#0072b2", true, {}, {}, false};
  for (const double n : found.samples) {
    expected.x.push_back(n);
    expected.y.push_back(found.error.front() / n);
  }
  record.pictures.push_back(save_plot({"samples of each pixel", "mean square error", true, true, {measured, expected}},
                                      folder, stem + ".error", "Error over samples",
                                      "Against a long reference, whose own error is subtracted."));
}

}  // namespace plumbline
