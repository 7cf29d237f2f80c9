// SPDX-License-Identifier: GPL-3.0-or-later
// What each family of tests asks. Half of the level is the spread's, the rest is shared evenly by the others.
#include "harness/compare_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/differences.h"
#include "harness/sign_flips.h"
#include "reports/format.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double kSpreadShare = 0.5;
constexpr double kOthers = 6.0;  ///< families beside it
constexpr double kPower = 0.99;
constexpr std::array<const char*, 3> kChannels{"red", "green", "blue"};

double share_of(double part, double whole) { return whole > 0.0 ? 100.0 * part / whole : 0.0; }

/// Gathers the tests of a family.
class Gathered {
 public:
  Gathered(std::string name, std::string sees, double level) {
    family_.name = std::move(name);
    family_.sees = std::move(sees);
    family_.level = level;
  }

  /// `what` tells of the worst when it is asked for.
  template <class What>
  void add(const DifferenceTest& test, What what) {
    ++family_.tests;
    deviations_.push_back(test.deviation);
    if (family_.tests > 1 && !(test.p < least_)) return;
    least_ = test.p;
    family_.worst = what() + ", z = " + value_text(test.z);
  }

  /// What one of its tests would see, by the median deviation of those that have any.
  double detectable() const {
    std::vector<double> noisy;
    for (const double d : deviations_)
      if (d > 0.0) noisy.push_back(d);
    if (noisy.empty() || family_.tests == 0) return 0.0;
    std::nth_element(noisy.begin(), noisy.begin() + static_cast<std::ptrdiff_t>(noisy.size() / 2), noisy.end());
    return noisy[noisy.size() / 2] *
           detectable_mean(1.0, count_, family_.level / static_cast<double>(family_.tests), kPower);
  }
  void set_count(std::size_t count) { count_ = count; }

  TestFamily done(std::string would_see) {
    family_.p = family_.tests > 0 ? std::min(1.0, least_ * static_cast<double>(family_.tests)) : 1.0;
    family_.would_see = std::move(would_see);
    return family_;
  }
  const TestFamily& family() const { return family_; }

 private:
  TestFamily family_;
  double least_ = 1.0;
  std::size_t count_ = 2;
  std::vector<double> deviations_;
};

using Sequence = std::vector<double>;

class Comparer {
 public:
  Comparer(const std::vector<PictureMoments>& tested, const std::vector<PictureMoments>& truth,
           const CompareOptions& options)
      : tested_(tested), truth_(truth), options_(options), pixels_(tested.front().mean.size()) {
    const PictureMoments& first = tested.front();
    PLUMBLINE_ASSERT(tested.size() == truth.size() && tested.size() >= 8);
    for (const auto* batches : {&tested, &truth})
      for (const PictureMoments& batch : *batches)
        PLUMBLINE_ASSERT(batch.width == first.width && batch.height == first.height && batch.frames == first.frames &&
                         batch.mean.size() == pixels_);
    PLUMBLINE_ASSERT(options.rounding.empty() || options.rounding.size() == pixels_);
    result_.width = first.width;
    result_.height = first.height;
    result_.frames = first.frames;
    result_.batches = static_cast<std::uint32_t>(tested.size());
    result_.level = options.level;
    result_.tested = pixel_means(tested);
    result_.truth = pixel_means(truth);
    result_.mean_tested = mean_of(result_.tested);
    result_.mean_truth = mean_of(result_.truth);
    brightness_ = (result_.mean_truth.x + result_.mean_truth.y + result_.mean_truth.z) / 3.0;
  }

  PictureComparison compare() {
    compare_pixels();
    compare_tiles();
    compare_whole();
    compare_variances();
    if (options_.pixels_independent) compare_neighbours();
    if (!options_.directions.empty()) compare_directions();
    compare_spread();
    return std::move(result_);
  }

 private:
  static glm::dvec3 mean_of(const std::vector<glm::dvec3>& picture) {
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& color : picture) sum += color;
    return sum / static_cast<double>(picture.size());
  }
  double level_of_others() const { return options_.level * (1.0 - kSpreadShare) / kOthers; }
  double rounding(std::size_t pixel, int channel) const {
    return options_.rounding.empty() ? 0.0 : options_.rounding[pixel][channel];
  }
  std::string place(std::size_t pixel) const {
    return std::to_string(pixel % static_cast<std::size_t>(result_.width)) + "," +
           std::to_string(pixel / static_cast<std::size_t>(result_.width));
  }
  /// Mean over the batches of a pixel's channel.
  static double pooled(const std::vector<PictureMoments>& batches, std::size_t pixel, int channel) {
    double sum = 0.0;
    for (const PictureMoments& batch : batches) sum += batch.mean[pixel][channel];
    return sum / static_cast<double>(batches.size());
  }
  std::string against(std::size_t pixel, int channel) const {
    return std::string(kChannels[static_cast<std::size_t>(channel)]) + ": " +
           value_text(pooled(tested_, pixel, channel)) + " against " + value_text(pooled(truth_, pixel, channel));
  }
  Sequence differences(const std::function<double(const PictureMoments&)>& figure) const {
    Sequence d;
    for (std::size_t b = 0; b < tested_.size(); ++b) d.push_back(figure(tested_[b]) - figure(truth_[b]));
    return d;
  }

  void compare_pixels() {
    Gathered family("pixels", "an error of single pixels: an edge, a highlight, a wrong primitive", level_of_others());
    family.set_count(tested_.size());
    Sequence d(tested_.size()), bright(tested_.size());
    for (std::size_t i = 0; i < pixels_; ++i) {
      std::fill(bright.begin(), bright.end(), 0.0);
      double slack = 0.0;
      for (int c = 0; c < 3; ++c) {
        for (std::size_t b = 0; b < d.size(); ++b) {
          d[b] = tested_[b].mean[i][c] - truth_[b].mean[i][c];
          bright[b] += d[b] / 3.0;
        }
        slack += rounding(i, c) / 3.0;
        family.add(test_differences(d, rounding(i, c)), [&] { return "pixel " + place(i) + ", " + against(i, c); });
      }
      result_.z.push_back(static_cast<float>(test_differences(bright, slack).z));
    }
    const std::string seen =
        "a bias of " + value_text(share_of(family.detectable(), brightness_)) + " % in a typical pixel";
    result_.families.push_back(family.done(seen));
  }

  /// Calls `each(first column, first row, pixels of the tile)`.
  template <class Each>
  void over_tiles(Each each) const {
    for (int top = 0; top < result_.height; top += options_.tile)
      for (int left = 0; left < result_.width; left += options_.tile) {
        std::vector<std::size_t> tile;
        for (int y = top; y < std::min(top + options_.tile, result_.height); ++y)
          for (int x = left; x < std::min(left + options_.tile, result_.width); ++x)
            tile.push_back(static_cast<std::size_t>(y) * static_cast<std::size_t>(result_.width) +
                           static_cast<std::size_t>(x));
        each(left, top, tile);
      }
  }
  std::vector<std::size_t> whole() const {
    std::vector<std::size_t> all(pixels_);
    for (std::size_t i = 0; i < pixels_; ++i) all[i] = i;
    return all;
  }
  double slack_of(const std::vector<std::size_t>& pixels, int channel) const {
    double sum = 0.0;
    for (const std::size_t i : pixels) sum += rounding(i, channel);
    return sum / static_cast<double>(pixels.size());
  }
  DifferenceTest test_mean(const std::vector<std::size_t>& pixels, int channel) const {
    return test_differences(differences([&](const PictureMoments& batch) {
                              double sum = 0.0;
                              for (const std::size_t i : pixels) sum += batch.mean[i][channel];
                              return sum / static_cast<double>(pixels.size());
                            }),
                            slack_of(pixels, channel));
  }

  void compare_tiles() {
    Gathered family("tiles", "an error of a region: a penumbra, a reflection, a texture", level_of_others());
    family.set_count(tested_.size());
    over_tiles([&](int left, int top, const std::vector<std::size_t>& tile) {
      for (int c = 0; c < 3; ++c) {
        const DifferenceTest test = test_mean(tile, c);
        family.add(test, [&] {
          return "tile at " + std::to_string(left) + "," + std::to_string(top) + ", " +
                 kChannels[static_cast<std::size_t>(c)] + ": off by " + value_text(test.mean);
        });
      }
    });
    const std::string seen =
        "a bias of " + value_text(share_of(family.detectable(), brightness_)) + " % in a typical tile";
    result_.families.push_back(family.done(seen));
  }

  void compare_whole() {
    Gathered family("whole picture", "a small error everywhere: a factor, a lost bounce", level_of_others());
    family.set_count(tested_.size());
    for (int c = 0; c < 3; ++c) {
      const DifferenceTest test = test_mean(whole(), c);
      family.add(test, [&] {
        return std::string(kChannels[static_cast<std::size_t>(c)]) + ": " + value_text(result_.mean_tested[c]) +
               " against " + value_text(result_.mean_truth[c]);
      });
    }
    result_.whole_student_p = test_differences(differences([&](const PictureMoments& batch) {
                                double sum = 0.0;
                                for (const glm::dvec3& color : batch.mean) sum += color.x + color.y + color.z;
                                return sum;
                              })).student_p;
    result_.whole_detectable = brightness_ > 0.0 ? family.detectable() / brightness_ : 0.0;
    const std::string seen = "a bias of " + value_text(100.0 * result_.whole_detectable) + " % of the mean";
    result_.families.push_back(family.done(seen));
  }

  /// Of one sample: of tiles and of the whole picture. What rounding may do to a variance follows from what it may do
  /// to a sample: |v' - v| <= 2 r sqrt(v) + r^2.
  void compare_variances() {
    Gathered family("variances", "the right mean from a wrong density", level_of_others());
    family.set_count(tested_.size());
    const bool known = !tested_.front().variance.empty() && !truth_.front().variance.empty();
    const auto test = [&](const std::vector<std::size_t>& pixels, int c, const std::string& where) {
      double slack = 0.0;
      for (const std::size_t i : pixels) {
        double variance = 0.0;
        for (const PictureMoments& batch : truth_)
          variance += batch.variance[i][c] / static_cast<double>(truth_.size());
        const double r = rounding(i, c);
        slack += (2.0 * r * std::sqrt(variance) + r * r) / static_cast<double>(pixels.size());
      }
      const DifferenceTest found = test_differences(differences([&](const PictureMoments& batch) {
                                                      double sum = 0.0;
                                                      for (const std::size_t i : pixels) sum += batch.variance[i][c];
                                                      return sum / static_cast<double>(pixels.size());
                                                    }),
                                                    slack);
      family.add(found, [&] {
        return where + ", " + kChannels[static_cast<std::size_t>(c)] + ": off by " + value_text(found.mean);
      });
    };
    double mean_variance = 0.0;
    if (known) {
      over_tiles([&](int left, int top, const std::vector<std::size_t>& tile) {
        for (int c = 0; c < 3; ++c) test(tile, c, "tile at " + std::to_string(left) + "," + std::to_string(top));
      });
      for (int c = 0; c < 3; ++c) test(whole(), c, "whole picture");
      for (const PictureMoments& batch : truth_)
        for (const glm::dvec3& v : batch.variance) mean_variance += v.x + v.y + v.z;
      mean_variance /= 3.0 * static_cast<double>(truth_.size() * pixels_);
    }
    const std::string seen =
        value_text(share_of(family.detectable(), mean_variance)) + " % of the variance in a typical tile";
    result_.families.push_back(family.done(known ? seen : ""));
  }

  /// Noise of neighbouring pixels, as a correlation: of the changes from one batch to the next, so that means cancel.
  /// The norm is taken over both engines, so exchanging them exchanges the sign.
  void compare_neighbours() {
    Gathered family("neighbours", "pixels that share random numbers", level_of_others());
    const std::size_t pairs = tested_.size() / 2;
    family.set_count(pairs);
    const auto change = [&](const std::vector<PictureMoments>& batches, std::size_t pair, std::size_t i) {
      const glm::dvec3 d = batches[2 * pair + 1].mean[i] - batches[2 * pair].mean[i];
      return d.x + d.y + d.z;
    };
    std::vector<double> scale(pixels_, 0.0);
    for (std::size_t i = 0; i < pixels_; ++i) {
      double squares = 0.0;
      for (std::size_t pair = 0; pair < pairs; ++pair)
        for (const auto* batches : {&tested_, &truth_}) squares += std::pow(change(*batches, pair, i), 2);
      if (squares > 0.0) scale[i] = 1.0 / std::sqrt(squares / (2.0 * static_cast<double>(pairs)));
    }
    double detectable = 0.0;
    const auto w = static_cast<std::size_t>(result_.width), h = static_cast<std::size_t>(result_.height);
    for (const std::size_t step : {std::size_t{1}, w}) {
      const auto correlation = [&](const std::vector<PictureMoments>& batches, std::size_t pair) {
        double sum = 0.0;
        for (std::size_t i = 0; i + step < w * h; ++i)
          if (step == w || i % w + 1 < w)
            sum += change(batches, pair, i) * scale[i] * change(batches, pair, i + step) * scale[i + step];
        return sum / static_cast<double>(pixels_);
      };
      Sequence d;
      for (std::size_t pair = 0; pair < pairs; ++pair)
        d.push_back(correlation(tested_, pair) - correlation(truth_, pair));
      const DifferenceTest test = test_differences(d);
      family.add(test, [&] {
        return std::string(step == 1 ? "in a row" : "in a column") + ": correlation off by " + value_text(test.mean);
      });
      detectable = std::max(detectable, detectable_mean(test.deviation, pairs, family.family().level / 2.0, kPower));
    }
    result_.families.push_back(family.done("a correlation of " + value_text(detectable)));
  }

  void compare_directions() {
    Gathered family("directions", "a parameter that is off", level_of_others());
    family.set_count(tested_.size());
    const double level = level_of_others() / static_cast<double>(options_.directions.size());
    for (const Direction& direction : options_.directions) {
      double slack = 0.0, length = 0.0;
      for (std::size_t i = 0; i < pixels_; ++i) {
        for (int c = 0; c < 3; ++c) slack += std::fabs(direction.weight[i][c]) * rounding(i, c);
        length += glm::dot(direction.weight[i], direction.change[i]);
      }
      const DifferenceTest test = test_differences(differences([&](const PictureMoments& batch) {
                                                     double sum = 0.0;
                                                     for (std::size_t i = 0; i < pixels_; ++i)
                                                       sum += glm::dot(direction.weight[i], batch.mean[i]);
                                                     return sum;
                                                   }),
                                                   slack);
      const double units = length > 0.0 ? direction.scale / length : 0.0;
      const Fit fit{direction.name, direction.unit, test.mean * units, interval_of(test, 0.99) * units,
                    detectable_mean(test.deviation, test.count, level, kPower) * units};
      family.add(test, [&] {
        return fit.name + " off by " + value_text(fit.value) + " " + fit.unit + " (99 %: +- " +
               value_text(fit.interval) + ")";
      });
      result_.fits.push_back(fit);
    }
    std::string seen;
    for (const Fit& fit : result_.fits)
      seen += (seen.empty() ? "" : ", ") + fit.name + " off by " + value_text(fit.detectable) + " " + fit.unit;
    result_.families.push_back(family.done(seen));
  }

  /// Pixels whose brightness has noise enough: at least 16 batches take part ((sum d^2)^2 / sum d^4), and what rounding
  /// may do is below a fiftieth of the deviation of their mean. Neither depends on the signs.
  std::vector<std::vector<float>> noisy_pixels() const {
    std::vector<std::vector<float>> differences(tested_.size());
    const auto n = static_cast<double>(tested_.size());
    Sequence d(tested_.size());
    for (std::size_t i = 0; i < pixels_; ++i) {
      double squares = 0.0, fourths = 0.0, slack = 0.0;
      for (std::size_t b = 0; b < d.size(); ++b) {
        const glm::dvec3 off = tested_[b].mean[i] - truth_[b].mean[i];
        d[b] = (off.x + off.y + off.z) / 3.0;
        squares += d[b] * d[b];
        fourths += d[b] * d[b] * d[b] * d[b];
      }
      for (int c = 0; c < 3; ++c) slack += rounding(i, c) / 3.0;
      if (!(squares * squares >= 16.0 * fourths && squares > 2500.0 * slack * slack * n * n && squares > 0.0)) continue;
      for (std::size_t b = 0; b < d.size(); ++b)
        differences[b].push_back(static_cast<float>(d[b] / std::sqrt(squares)));
    }
    return differences;
  }

  void compare_spread() {
    TestFamily family;
    family.name = "spread of p-values";
    family.sees = "many errors too small for any pixel, of either sign";
    family.level = options_.level * kSpreadShare;
    // Where another family has raised an alarm already a picture of the spread will do.
    const auto needed = static_cast<std::uint64_t>(3.0 / family.level) + 64;
    const std::uint64_t most = options_.most_flips > 0 ? options_.most_flips : result_.alarm() ? 2000 : needed;
    SpreadTest test = test_spread(noisy_pixels(), options_.seed, most);
    family.tests = test.values;
    family.p = test.p;
    family.worst = "Kolmogorov-Smirnov " + value_text(test.kolmogorov) + ", Anderson-Darling " +
                   value_text(test.anderson) + ", by " + counted(test.flips, "flip");
    result_.p_values = std::move(test.p_values);
    result_.families.push_back(std::move(family));
  }

  const std::vector<PictureMoments>&tested_, &truth_;
  const CompareOptions& options_;
  const std::size_t pixels_;
  double brightness_ = 0.0;
  PictureComparison result_;
};

}  // namespace

bool PictureComparison::alarm() const {
  return std::any_of(families.begin(), families.end(), [](const TestFamily& family) { return family.alarm(); });
}

double PictureComparison::p() const {
  double least = 1.0;
  for (const TestFamily& family : families)
    if (family.tests > 0) least = std::min(least, family.p * level / family.level);
  return least;
}

std::string PictureComparison::verdict() const {
  std::string text;
  for (const TestFamily& family : families)
    if (family.alarm()) text += (text.empty() ? "" : "; ") + family.name + ": " + family.worst;
  if (!text.empty()) return text;
  if (whole_detectable == 0.0) return "no difference; no sample varies";
  return "no difference; a bias of " + value_text(100.0 * whole_detectable) +
         " % of the mean would be seen with probability 0.99";
}

std::vector<PictureMoments> take_batches(PictureEngine& engine, std::uint32_t batches, std::uint32_t frames,
                                         const std::function<void(double)>& progress) {
  std::vector<PictureMoments> taken;
  for (std::uint32_t b = 0; b < batches; ++b) {
    taken.push_back(engine.render(b * frames, frames));
    if (progress) progress(static_cast<double>(b + 1) / batches);
  }
  return taken;
}

PictureComparison compare_pictures(const std::vector<PictureMoments>& tested, const std::vector<PictureMoments>& truth,
                                   const CompareOptions& options) {
  PLUMBLINE_ASSERT(!tested.empty());
  return Comparer(tested, truth, options).compare();
}

}  // namespace plumbline
