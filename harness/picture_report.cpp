// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/picture_report.h"

#include <algorithm>
#include <cmath>

#include "reports/format.h"
#include "reports/picture.h"
#include "reports/plot.h"

namespace plumbline {
namespace {

constexpr const char* kFound = "#d55e00";
constexpr const char* kExpected = "#0072b2";

/// Of 20 classes, as a share of what is expected of each; dashed lines hold 99 % of the classes of independent pixels.
Plot histogram_of(const std::vector<double>& p_values) {
  constexpr int kClasses = 20;
  std::vector<double> counts(kClasses, 0.0);
  for (const double p : p_values)
    counts[static_cast<std::size_t>(std::min(kClasses - 1, static_cast<int>(p * kClasses)))] += 1.0;
  const double expected = static_cast<double>(p_values.size()) / kClasses;
  const double band = 2.576 * std::sqrt(expected * (1.0 - 1.0 / kClasses)) / expected;
  PlotSeries steps{"pixels", kFound, false, {}, {}, false};
  for (int i = 0; i < kClasses; ++i)
    for (const int end : {i, i + 1}) {
      steps.x.push_back(static_cast<double>(end) / kClasses);
      steps.y.push_back(counts[static_cast<std::size_t>(i)] / expected);
    }
  const PlotSeries low{
      "99 % of classes, if pixels are independent", kExpected, true, {0, 1}, {1 - band, 1 - band}, false};
  const PlotSeries high{"", kExpected, true, {0, 1}, {1 + band, 1 + band}, false};
  return {"p-value of a pixel (Student)", "pixels, as a share of those expected", false, false, {steps, low, high}};
}

/// The smallest p-values against those expected of them: logarithmic, as small ones matter.
Plot quantiles_of(std::vector<double> p_values) {
  std::sort(p_values.begin(), p_values.end());
  PlotSeries found{"pixels", kFound, false, {}, {}}, line{"as expected", kExpected, true, {}, {}, false};
  const std::size_t n = p_values.size();
  for (std::size_t i = 0; i < n; i += std::max<std::size_t>(1, i / 8)) {
    const double expected = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    found.x.push_back(-std::log10(expected));
    found.y.push_back(-std::log10(std::max(p_values[i], 1e-30)));
  }
  line.x = line.y = {0.0, found.x.empty() ? 1.0 : found.x.front()};
  return {"-log10 of the p-value expected at this rank", "-log10 of the p-value found", false, false, {found, line}};
}

}  // namespace

void record_pair(const PicturePair& pair, const std::filesystem::path& folder, const std::string& stem,
                 CaseRecord& record) {
  const auto save = [&](const Picture& picture, const char* what, const std::string& title,
                        const std::string& caption) {
    record.pictures.push_back(save_picture(picture, folder, stem + "." + what, title, caption));
  };
  save(paint_colors(pair.tested, pair.width, pair.height), "tested", pair.tested_name, pair.caption);
  save(paint_colors(pair.truth, pair.width, pair.height), "truth", pair.truth_name, pair.caption);
  std::vector<float> means, sizes, channels;
  for (std::size_t i = 0; i < pair.tested.size(); ++i) {
    const glm::dvec3 off = pair.tested[i] - pair.truth[i];
    means.push_back(static_cast<float>((off.x + off.y + off.z) / 3.0));
    sizes.push_back(std::fabs(means.back()));
    for (int c = 0; c < 3; ++c) channels.push_back(static_cast<float>(off[c]));
    channels.push_back(means.back());
  }
  // Full colour at the greatest of 99 % of the pixels: one outlier must not hide the rest.
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 99 / 100);
  std::nth_element(sizes.begin(), at, sizes.end());
  const double limit = *at > 0.0f ? static_cast<double>(*at) : 1.0;
  Picture difference = paint_signed(means, pair.width, pair.height, "linear colour", limit);
  difference.values = {"linear colour", {"R", "G", "B", "mean"}, {}, std::move(channels)};
  save(difference, "difference", pair.tested_name + " less " + pair.truth_name,
       "Mean of the three channels: orange where " + pair.tested_name + " is brighter, blue where it is darker.");
}

void record_comparison(const PictureComparison& comparison, const std::filesystem::path& folder,
                       const std::string& stem, CaseRecord& record) {
  if (comparison.alarm()) record.status = CaseStatus::failed;
  record.message = comparison.verdict();
  const double samples = static_cast<double>(comparison.z.size()) * comparison.batches * comparison.frames;
  record.figures.push_back({"samples of each engine", "", samples});
  record.figures.push_back({"p of the comparison", "", comparison.p()});
  record.figures.push_back({"bias that would be seen", "%", 100.0 * comparison.whole_detectable});

  TableRecord tests{"Tests, corrected for their number; power at 0.99",
                    {"test", "sees", "tests", "least p", "level", "worst", "would see"},
                    {}};
  for (const TestFamily& family : comparison.families)
    tests.rows.push_back({family.name, family.sees, grouped(family.tests), value_text(family.p),
                          value_text(family.level), family.worst, family.would_see});
  record.tables.push_back(std::move(tests));
  if (!comparison.fits.empty()) {
    TableRecord fits{"What a parameter would have to be off by to explain the difference",
                     {"parameter", "off by", "99 % interval", "would see", "unit"},
                     {}};
    for (const Fit& fit : comparison.fits) {
      fits.rows.push_back(
          {fit.name, value_text(fit.value), "+- " + value_text(fit.interval), value_text(fit.detectable), fit.unit});
      record.figures.push_back({fit.name + " off by", fit.unit, fit.value});
    }
    record.tables.push_back(std::move(fits));
  }

  record_pair({comparison.tested, comparison.truth, comparison.width, comparison.height, "Tracer", "Reference",
               "Mean of " + counted(std::uint64_t{comparison.batches} * comparison.frames, "sample") + " a pixel."},
              folder, stem, record);
  record.pictures.push_back(save_picture(
      paint_signed(comparison.z, comparison.width, comparison.height, "standard deviations", 4.0), folder, stem + ".z",
      "Map of z",
      "The difference of the two engines' brightness over its own standard deviation, by Student: orange where the "
      "tested one is brighter, 0 where rounding may be all. Shapes of the scene should not be seen."));
  if (comparison.p_values.empty()) return;
  record.pictures.push_back(save_plot(histogram_of(comparison.p_values), folder, stem + ".histogram",
                                      "Histogram of p-values",
                                      "Flat where both engines draw from the same distributions; high on the left "
                                      "where they do not."));
  record.pictures.push_back(save_plot(quantiles_of(comparison.p_values), folder, stem + ".quantiles",
                                      "Quantiles of p-values",
                                      "On the line where both engines agree; above it where small p-values are too "
                                      "many."));
}

}  // namespace plumbline
