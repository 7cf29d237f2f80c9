// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pooling. z_1 ... z_n of n nights with seeds of their own are independent and normal with variance 1. If nothing is
// wrong their mean is 0 and Z = (z_1 + ... + z_n) / sqrt(n) is normal too (Stouffer 1949). A bias that moves each night
// by d moves Z by d sqrt(n): thirty nights see what is 5.5 times too small for one. A p-value counts as the z of the
// same tail.
//
// False alarms. All nights of a year together may raise kAlarmsPerYear = 0.1 of them by pooling, a tenth of what the
// whole of Plumbline may. Of m figures on each of 365 nights, each gets the level 0.1 / (365 m) (Bonferroni: the
// windows of thirty nights overlap, and the bound needs no independence).
//
// Slower. x = log(seconds) of a case scatters about its own mean with its own variance, and every night as a whole runs
// at its own speed (another job on the machine), the same factor for all. So each night's factor is taken out first:
// the median over all cases of x less the case's median. What is left of a case's n earlier runs has mean x0 and
// deviation s, and a new one differs from x0 by Student's t with n - 1 degrees of freedom times s sqrt(1 + 1/n). It is
// slower if it exceeds x0 + log(kLeastSlowdown) by more than the t whose tail is 0.1 / (365 m) of m cases. Slowdowns
// below kLeastSlowdown are nobody's concern, however sure.
#include "harness/nights.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace plumbline {
namespace {

constexpr double kAlarmsPerYear = 0.1, kNightsPerYear = 365.0;
constexpr double kLeastSlowdown = 1.05;

double level_of(std::size_t questions) {
  return kAlarmsPerYear / (kNightsPerYear * static_cast<double>(std::max<std::size_t>(1, questions)));
}

double upper_tail(double z) { return cdf(complement(boost::math::normal_distribution<double>(), z)); }

bool is_statistic(const Figure& figure) { return figure.unit == kUnitZ || figure.unit == kUnitP; }
double z_of(const Figure& figure) { return figure.unit == kUnitP ? z_of_p(figure.value) : figure.value; }

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// log(seconds) of a case, by the start of the run; this run's own stands apart.
struct Times {
  std::string name;
  double now = 0.0, usual = 0.0;
  std::map<std::string, double> before;
};

std::vector<Times> times_of(const RunRecord& run, const History& history) {
  const std::string driver = run.driver_renderer + ", " + run.driver_version;
  std::vector<Times> all;
  for (const CaseRecord& record : run.cases) {
    if (outcome(record) != CaseStatus::passed || !(record.seconds > 0.0)) continue;
    Times times{record.name, std::log(record.seconds), 0.0, {}};
    for (const PastCase& past : history.last_answers(record.name, kPooledNights, &run))
      if (past.status == CaseStatus::passed && past.seconds > 0.0 && past.rays == record.rays &&
          past.machine == run.machine && past.driver == driver)
        times.before[past.started] = std::log(past.seconds);
    if (times.before.size() < kFewestRuns) continue;
    std::vector<double> values;
    for (const auto& [started, x] : times.before) values.push_back(x);
    times.usual = median(values);
    all.push_back(std::move(times));
  }
  return all;
}

}  // namespace

double z_of_p(double p) {
  if (!(p >= 0.0 && p <= 1.0)) return std::numeric_limits<double>::quiet_NaN();
  if (p == 0.0) return std::numeric_limits<double>::infinity();
  if (p == 1.0) return -std::numeric_limits<double>::infinity();
  return quantile(complement(boost::math::normal_distribution<double>(), p));
}

PooledFigure pooled(const std::vector<double>& z, bool two_sided, std::size_t figures) {
  PooledFigure result;
  result.nights = z.size();
  result.threshold = level_of(figures);
  double sum = 0.0;
  for (const double value : z) sum += value;
  result.z = z.empty() ? 0.0 : sum / std::sqrt(static_cast<double>(z.size()));
  if (std::isnan(result.z))
    result.p = 0.0;
  else
    result.p = two_sided ? std::min(1.0, 2.0 * upper_tail(std::abs(result.z))) : upper_tail(result.z);
  return result;
}

std::vector<PooledFigure> pooled_figures(const RunRecord& run, const History& history) {
  std::size_t questions = 0;
  for (const CaseRecord& record : run.cases)
    questions += static_cast<std::size_t>(std::count_if(record.figures.begin(), record.figures.end(), is_statistic));
  std::vector<PooledFigure> all;
  for (const CaseRecord& record : run.cases) {
    if (std::none_of(record.figures.begin(), record.figures.end(), is_statistic)) continue;
    // More runs than nights: some may repeat a seed.
    const std::vector<PastCase> past = history.last_answers(record.name, 4 * kPooledNights, &run);
    for (const Figure& figure : record.figures) {
      if (!is_statistic(figure)) continue;
      std::vector<double> z = {z_of(figure)};
      std::set<std::uint64_t> seeds = {run.seed};
      for (const PastCase& night : past) {
        const auto same = std::find_if(night.figures.begin(), night.figures.end(),
                                       [&](const Figure& f) { return f.name == figure.name && f.unit == figure.unit; });
        if (same == night.figures.end() || z.size() == kPooledNights || !seeds.insert(night.run_seed).second) continue;
        z.push_back(z_of(*same));
      }
      all.push_back(pooled(z, figure.unit == kUnitZ, questions));
      all.back().case_name = record.name;
      all.back().figure = figure.name;
    }
  }
  return all;
}

void find_slower(const RunRecord& run, const History& history, RunChanges& changes) {
  const std::vector<Times> all = times_of(run, history);
  std::map<std::string, std::vector<double>> nights;
  std::vector<double> tonight;
  for (const Times& times : all) {
    tonight.push_back(times.now - times.usual);
    for (const auto& [started, x] : times.before) nights[started].push_back(x - times.usual);
  }
  std::map<std::string, double> speed;
  for (const auto& [started, shifts] : nights) speed[started] = median(shifts);
  const double now = median(tonight);
  changes.night_speed = std::exp(now);
  for (const Times& times : all) {
    const auto n = static_cast<double>(times.before.size());
    double sum = 0.0, squares = 0.0;
    for (const auto& [started, x] : times.before) sum += x - speed[started];
    const double mean = sum / n;
    for (const auto& [started, x] : times.before) squares += std::pow(x - speed[started] - mean, 2.0);
    const double spread = std::sqrt(squares / (n - 1.0) * (1.0 + 1.0 / n));
    const double t = quantile(complement(boost::math::students_t_distribution<double>(n - 1.0), level_of(all.size())));
    if (times.now - now > mean + std::log(kLeastSlowdown) + t * spread)
      changes.slower.push_back({times.name, std::exp(times.now), std::exp(mean + now), times.before.size()});
  }
}

RunChanges changes_since(const RunRecord& run, const History& history) {
  RunChanges changes = history.changes_since_last(run);
  changes.pooled = pooled_figures(run, history);
  find_slower(run, history, changes);
  return changes;
}

}  // namespace plumbline
