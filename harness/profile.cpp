// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/profile.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double kPower = 0.99;
constexpr double kTests = 3.0;  ///< of the worst point, of their squares, of their sum
/// A mean of n samples of skewness g has the skewness g / sqrt(n). Above this (of events of small chance: fewer than
/// 100) a point is joined with its neighbour.
constexpr double kLargestSkewness = 0.1;

/// The sum of all samples of some pixels, less its expectation.
struct Sum {
  double place = 0.0, expected = 0.0, measured = 0.0, variance = 0.0, third = 0.0, slope = 0.0, pixels = 0.0;
  std::size_t point = 0;

  Sum& operator+=(const Sum& o) {
    place += o.place, expected += o.expected, measured += o.measured;
    variance += o.variance, third += o.third, slope += o.slope, pixels += o.pixels;
    return *this;
  }
  double skewness() const { return third / (variance * std::sqrt(variance)); }
};

double two_sided(double z) {
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::fabs(z)));
}

/// The deviation in standard errors, the first order of its skewness taken out (Cornish and Fisher 1938); what is left
/// is of the order of 1 / n.
double normal_score(const Sum& sum) {
  const double z = (sum.measured - sum.expected) / std::sqrt(sum.variance);
  return z - sum.skewness() * (z * z - 1.0) / 6.0;
}

bool is_near(double a, double b) { return std::fabs(a - b) <= kColorRounding; }

/// Whether a pixel shows nothing that its samples cannot give, whatever chance does: without variance the exact value;
/// with the values 0 and 1 alone the variance that goes with its mean; white is white.
bool is_possible(const SampleMoments& sample, const glm::dvec3& mean, const glm::dvec3& variance, double frames) {
  if (!is_near(mean.r, mean.g) || !is_near(mean.b, mean.g) || !(std::isfinite(mean.g))) return false;
  if (sample.variance == 0.0) return is_near(mean.g, sample.mean) && is_near(variance.g, 0.0);
  if (sample.two_valued) return is_near(variance.g, mean.g * (1.0 - mean.g) * frames / (frames - 1.0));
  return variance.g >= 0.0;
}

/// Points in order, those with few events joined with the next (the last with the one before).
std::vector<Sum> joined(const std::vector<Sum>& points) {
  std::vector<Sum> result;
  bool is_open = false;
  for (const Sum& point : points) {
    if (!(point.variance > 0.0)) continue;
    if (is_open)
      result.back() += point;
    else
      result.push_back(point);
    is_open = std::fabs(result.back().skewness()) > kLargestSkewness;
  }
  if (is_open && result.size() > 1) {
    const Sum last = result.back();
    result.pop_back();
    result.back() += last;
  }
  return result;
}

/// The lower triangle L of a correlation matrix, L L^T, row by row; the rows that depend on others are left out.
struct Whitener {
  std::vector<std::vector<double>> rows;
  std::vector<std::size_t> kept;

  explicit Whitener(const std::vector<std::vector<double>>& matrix) {
    for (std::size_t i = 0; i < matrix.size(); ++i) {
      std::vector<double> row = solve([&](std::size_t k) { return matrix[i][kept[k]]; });
      double rest = matrix[i][i];
      for (const double x : row) rest -= x * x;
      if (!(rest > 1e-9 * matrix[i][i])) continue;
      row.push_back(std::sqrt(rest));
      rows.push_back(row);
      kept.push_back(i);
    }
  }
  /// x with L x = b, b given for the kept rows.
  template <class B>
  std::vector<double> solve(B b) const {
    std::vector<double> x;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      double sum = b(k);
      for (std::size_t j = 0; j < k; ++j) sum -= rows[k][j] * x[j];
      x.push_back(sum / rows[k][k]);
    }
    return x;
  }
};

double covariance(const Profile::Interval& a, const Profile::Interval& b) {
  const double both = std::max(0.0, std::min(a.to, b.to) - std::max(a.from, b.from));
  return both - (a.to - a.from) * (b.to - b.from);
}

/// How far a noncentral chi-square must be shifted to be above the level's value with probability kPower.
double needed_shift(double degrees) {
  const double limit =
      boost::math::quantile(boost::math::complement(boost::math::chi_squared(degrees), 0.5 * kCaseLevel / kTests));
  return boost::math::non_central_chi_squared::find_non_centrality(degrees, limit, 1.0 - kPower);
}

void judge_sum(double z, double chi_square, std::size_t degrees, double slopes, ProfileResult& result) {
  result.common_z = z;
  result.p_common = two_sided(z);
  result.chi_square = chi_square, result.degrees = static_cast<double>(degrees);
  const boost::math::chi_squared distribution(result.degrees);
  // Both sides: samples that are more even than independent ones are not what was promised either.
  const double above = boost::math::cdf(boost::math::complement(distribution, chi_square));
  result.p_chi_square = 2.0 * std::min(above, 1.0 - above);
  if (slopes > 0.0) result.detectable_size = std::sqrt(needed_shift(result.degrees) / slopes);
}

}  // namespace

SampleMoments SampleMoments::chance(double p) {
  // Closed forms of what nothing or everything covers end within some 2^-52 of 0 and 1.
  if (!(p > 1e-13)) return sure(0.0);
  if (!(p < 1.0 - 1e-13)) return sure(1.0);
  return {p, p * (1.0 - p), p * (1.0 - p) * (1.0 - 2.0 * p), true};
}

SampleMoments SampleMoments::from_raw(const std::array<double, 3>& raw) {
  const auto [m, second, third] = raw;
  if (!(m > 1e-13)) return sure(0.0);
  return {m, second - m * m, third - 3.0 * m * second + 2.0 * m * m * m, false};
}

ProfileResult judge_profile(const Profile& profile, const PictureMoments& picture, bool independent_pixels) {
  PLUMBLINE_ASSERT(picture.width == profile.width && picture.height == profile.height && picture.frames > 1);
  PLUMBLINE_ASSERT(picture.mean.size() == profile.pixels.size() && picture.variance.size() == profile.pixels.size());
  const double frames = picture.frames;
  const bool shares_time = !profile.exposed.empty(), apart = !independent_pixels && !shares_time;
  ProfileResult result;
  std::vector<Sum> sums(apart ? profile.pixels.size() : profile.place.size());
  for (std::size_t i = 0; i < profile.pixels.size(); ++i) {
    const SampleMoments& sample = profile.pixels[i];
    result.sure_pixels += sample.variance == 0.0;
    const bool possible = is_possible(sample, picture.mean[i], picture.variance[i], frames);
    result.wrong_pixels += !possible;
    if (!std::isfinite(picture.mean[i].g) || profile.point_of[i] == kNoPoint) continue;
    Sum one{profile.place[profile.point_of[i]],
            sample.mean,
            picture.mean[i].g,
            sample.variance / frames,
            sample.third / (frames * frames),
            profile.slope.empty() ? 0.0 : profile.slope[i],
            1.0,
            profile.point_of[i]};
    Sum& sum = sums[apart ? i : profile.point_of[i]];
    if (shares_time && sum.pixels > 0.0) {  // the same again: a frame tells nothing more by it
      result.wrong_pixels += !is_near(sum.measured, one.measured);
      continue;
    }
    one.point = sum.pixels > 0.0 ? sum.point : one.point;
    sum += one;
    sum.point = one.point;
  }

  std::vector<Sum> judged;
  if (shares_time || apart) {
    std::copy_if(sums.begin(), sums.end(), std::back_inserter(judged), [&](const Sum& s) {
      return s.variance > 0.0 && (shares_time || std::fabs(s.skewness()) <= kLargestSkewness);
    });
  } else {
    judged = joined(sums);
  }
  if (judged.empty()) {
    result.p = 1.0;
    return result;
  }

  double worst = 0.0, chi_square = 0.0, slopes = 0.0, least_error = INFINITY;
  Sum all;
  for (const Sum& sum : judged) {
    PointResult point;
    point.place = sum.place / sum.pixels;
    point.expected = sum.expected / sum.pixels;
    point.measured = sum.measured / sum.pixels;
    point.standard_error = std::sqrt(sum.variance) / sum.pixels;
    point.samples = sum.pixels * frames;
    point.z = normal_score(sum);
    worst = std::max(worst, std::fabs(point.z));
    chi_square += point.z * point.z;
    slopes += sum.slope * sum.slope / sum.variance;
    least_error = std::min(least_error, point.standard_error);
    all += sum;
    result.points.push_back(point);
  }
  const double count = static_cast<double>(judged.size());
  result.p_worst = std::min(1.0, count * two_sided(worst));
  const double tests = apart ? 1.0 : kTests;
  result.detectable_point =
      least_error *
      (boost::math::quantile(boost::math::complement(boost::math::normal(), 0.5 * kCaseLevel / (tests * count))) +
       boost::math::quantile(boost::math::normal(), kPower));
  if (apart) {
    result.p = result.p_worst;
    return result;
  }
  if (shares_time) {
    std::vector<std::vector<double>> matrix;
    double of_sum = 0.0;
    for (const Sum& a : judged) {
      auto& row = matrix.emplace_back();
      for (const Sum& b : judged)
        row.push_back(covariance(profile.exposed[a.point], profile.exposed[b.point]) / frames), of_sum += row.back();
    }
    const Whitener whitener(matrix);
    const auto squares = [&](auto value) {
      double sum = 0.0;
      for (const double x : whitener.solve([&](std::size_t k) { return value(judged[whitener.kept[k]]); }))
        sum += x * x;
      return sum;
    };
    all.variance = of_sum, all.third = 0.0;
    judge_sum(normal_score(all), squares([](const Sum& s) { return s.measured - s.expected; }), whitener.kept.size(),
              squares([](const Sum& s) { return s.slope; }), result);
  } else {
    judge_sum(normal_score(all), chi_square, judged.size(), slopes, result);
  }
  result.p = std::min(1.0, kTests * std::min({result.p_worst, result.p_chi_square, result.p_common}));
  return result;
}

}  // namespace plumbline
