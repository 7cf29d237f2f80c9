// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/closed_form_cases.h"

#include <algorithm>
#include <cmath>

#include "harness/tracer_engine.h"
#include "reports/format.h"
#include "reports/plot.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double kInterval = 2.5758293035489004;  ///< standard errors on either side: 99 % of a normal distribution
const char* const kColors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7"};

/// Adds the moments of further frames (Chan, Golub and LeVeque 1979).
void append(PictureMoments& all, const PictureMoments& more) {
  if (all.frames == 0) {
    all = more;
    return;
  }
  const double n = all.frames, m = more.frames, total = n + m;
  for (std::size_t i = 0; i < all.mean.size(); ++i) {
    const glm::dvec3 step = more.mean[i] - all.mean[i];
    const glm::dvec3 squares =
        (n - 1.0) * all.variance[i] + (m - 1.0) * more.variance[i] + step * step * (n * m / total);
    all.mean[i] += step * (m / total);
    all.variance[i] = squares / (total - 1.0);
  }
  all.frames += more.frames;
}

/// What the profile must be, point by point.
PlotSeries analytic_curve(const Profile& profile) {
  std::vector<double> sums(profile.place.size(), 0.0), pixels(profile.place.size(), 0.0);
  for (std::size_t i = 0; i < profile.pixels.size(); ++i)
    if (const std::uint32_t point = profile.point_of[i]; point != kNoPoint)
      sums[point] += profile.pixels[i].mean, pixels[point] += 1.0;
  PlotSeries curve{"analysis", "#444444", false, {}, {}};
  curve.marks = false;
  for (std::size_t point = 0; point < sums.size(); ++point)
    if (pixels[point] > 0.0) curve.x.push_back(profile.place[point]), curve.y.push_back(sums[point] / pixels[point]);
  return curve;
}

/// A level line across a plot.
PlotSeries level(const PlotSeries& like, double y, const std::string& label) {
  PlotSeries line{label, "#888888", true, {like.x.front(), like.x.back()}, {y, y}};
  line.marks = false;
  return line;
}

std::string signed_number(double value) { return (value < 0.0 ? "" : "+") + fixed(value, 2); }

/// One sentence on how a renderer kept to the profile.
std::string told(const std::string& name, const ProfileResult& r) {
  std::string text = name + ": ";
  if (r.wrong_pixels > 0) text += counted(r.wrong_pixels, "pixel") + " with a value that no samples give; ";
  if (r.points.empty()) return text + counted(r.sure_pixels - r.wrong_pixels, "pixel") + " without variance exact";
  double worst = 0.0, place = 0.0;
  for (const PointResult& point : r.points)
    if (std::fabs(point.z) > std::fabs(worst)) worst = point.z, place = point.place;
  text += "worst of " + counted(r.points.size(), "point") + " " + signed_number(worst) + " standard errors (at " +
          value_text(place) + ")";
  if (r.degrees > 0.0)
    text += ", chi-square " + fixed(r.chi_square, 1) + " of " + fixed(r.degrees, 0) + ", p = " + value_text(r.p);
  return text;
}

/// Its first column names the quantities; each renderer adds one.
TableRecord new_table(const ClosedFormInfo& info) {
  TableRecord table;
  table.title = "How each renderer kept to the profile";
  table.columns = {""};
  for (const char* const what :
       {"p", "points", "samples of a point, at least", "chi-square, as many degrees as points",
        "sum of all deviations (standard errors)", "pixels without variance",
        "pixels with a value that no samples give", "bias of a point that is seen with probability 0.99"})
    table.rows.push_back({what});
  if (!info.size.empty()) table.rows.push_back({"error of the " + info.size + " that is seen with probability 0.99"});
  return table;
}

void add_result(const std::string& name, const ClosedFormInfo& info, const ProfileResult& r, CaseRecord& record) {
  record.figures.push_back({name + ": p", "", r.p});
  if (r.degrees > 0.0) record.figures.push_back({name + ": z", "standard errors", r.common_z});
  double least = INFINITY;
  for (const PointResult& point : r.points) least = std::min(least, point.samples);
  const bool has_points = !r.points.empty(), has_sums = r.degrees > 0.0;
  std::vector<std::string> values{value_text(r.p),
                                  std::to_string(r.points.size()),
                                  has_points ? grouped(static_cast<std::uint64_t>(least)) : "",
                                  has_sums ? fixed(r.chi_square, 1) : "",
                                  has_sums ? signed_number(r.common_z) : "",
                                  grouped(r.sure_pixels),
                                  grouped(r.wrong_pixels),
                                  has_points ? value_text(r.detectable_point) : ""};
  if (!info.size.empty()) values.push_back(r.detectable_size > 0.0 ? fixed(100.0 * r.detectable_size, 2) + " %" : "");
  TableRecord& table = record.tables.front();
  PLUMBLINE_ASSERT(values.size() == table.rows.size());
  table.columns.push_back(name);
  for (std::size_t i = 0; i < values.size(); ++i) table.rows[i].push_back(values[i]);
}

Case case_of(const ClosedFormInfo& info, const PictureSources& sources, std::uint64_t samples) {
  Case c;
  c.name = info.name();
  c.feature = info.effect;
  c.scene = info.scene;
  c.family = info.model == Effects::Model::physical ? "physical" : "paper";
  c.paper = info.paper;
  c.rays = samples;
  c.proves = info.proves;
  c.run = [info, sources, samples](CaseContext& context, const Case& self, CaseRecord& record) {
    const ClosedForm form = with_slope(info);
    PlotSeries curve = analytic_curve(form.profile);
    Plot profile{info.axis, "mean colour", false, false, {curve}};
    Plot residuals{info.axis, "deviation (standard errors)", false, false, {}};
    residuals.series = {level(curve, kInterval, "99 %"), level(curve, -kInterval, "")};
    const std::vector<PictureSource> renderers = sources(context);
    record.tables.push_back(new_table(info));
    for (std::size_t i = 0; i < renderers.size(); ++i) {
      const PictureSource& source = renderers[i];
      // With motion blur alone nothing is drawn but the frame's time, which is no pixel's.
      if (!source.independent_pixels && !form.profile.exposed.empty()) continue;
      const std::uint32_t frames = frames_for(
          form.profile, static_cast<std::uint64_t>(std::llround(source.effort * static_cast<double>(samples))));
      const PictureMoments picture =
          render_profile(form, source, case_seed(context.seed, self.name), frames, [&](double share) {
            context.progress((static_cast<double>(i) + share) / static_cast<double>(renderers.size()));
          });
      const ProfileResult result = judge_profile(form.profile, picture, source.independent_pixels);
      if (!result.passed(kCaseLevel)) record.status = CaseStatus::failed;
      record.message += (record.message.empty() ? "" : "; ") + told(source.name, result);
      add_result(source.name, info, result, record);
      PlotSeries measured{source.name, kColors[i % std::size(kColors)], false, {}, {}}, deviation = measured;
      for (const PointResult& point : result.points) {
        measured.x.push_back(point.place), measured.y.push_back(point.measured);
        measured.low.push_back(point.measured - kInterval * point.standard_error);
        measured.high.push_back(point.measured + kInterval * point.standard_error);
        deviation.x.push_back(point.place), deviation.y.push_back(point.z);
      }
      measured.line = deviation.line = false;
      // Where each pixel is a point there are hundreds: the table tells of them.
      if (result.points.empty() || !source.independent_pixels) continue;
      residuals.series.push_back(std::move(deviation));
      profile.series.push_back(std::move(measured));
    }
    record.pictures.push_back(save_plot(profile, context.out, self.name + ".profile", "Profile",
                                        "Measured means with 99 % intervals over the analytic curve; bars shorter than "
                                        "the marks are hidden by them."));
    if (residuals.series.size() > 2)
      record.pictures.push_back(save_plot(residuals, context.out, self.name + ".residuals", "Residuals",
                                          "Measured less expected, in standard errors from the exact variance. One "
                                          "point in a hundred lies outside of the dashed lines."));
  };
  return c;
}

}  // namespace

PictureSources picture_sources(const std::vector<ShaderPatch>& patches) {
  return [patches](CaseContext&) -> std::vector<PictureSource> {
    RenderSettings own;
    own.patches = patches;
    RenderSettings with_image = own;
    with_image.random = RandomKind::texture;
    return {{"reference", make_reference_engine},
            {"tracer, hash", tracer_engines(own)},
            {"tracer, texture", tracer_engines(with_image), false, 0.125}};
  };
}

std::uint32_t frames_for(const Profile& profile, std::uint64_t samples) {
  constexpr std::uint32_t kWithoutVariance = 64, kLeast = 16, kMost = 0x7fffffff;
  if (!profile.exposed.empty())
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(samples / 4, kLeast, kMost));
  std::vector<std::uint64_t> pixels(profile.place.size(), 0);
  std::vector<bool> varies(profile.place.size(), false);
  for (std::size_t i = 0; i < profile.pixels.size(); ++i)
    if (const std::uint32_t point = profile.point_of[i]; point != kNoPoint) {
      ++pixels[point];
      if (profile.pixels[i].variance > 0.0) varies[point] = true;
    }
  std::uint64_t fewest = 0;
  for (std::size_t point = 0; point < pixels.size(); ++point)
    if (varies[point]) fewest = fewest > 0 ? std::min(fewest, pixels[point]) : pixels[point];
  if (fewest == 0) return kWithoutVariance;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>((samples + fewest - 1) / fewest, kLeast, kMost));
}

PictureMoments render_profile(const ClosedForm& form, const PictureSource& source, std::uint64_t seed,
                              std::uint32_t frames, const std::function<void(double)>& progress) {
  constexpr std::uint32_t kBatches = 32, kLeastBatch = 256;
  PictureSettings settings;
  settings.effects = form.scene.effects;
  settings.seed = seed;
  settings.time = form.time;
  const auto engine = source.make(form.scene, settings);
  PictureMoments all;
  const std::uint32_t batch = std::max(kLeastBatch, frames / kBatches);
  for (std::uint32_t first = 0; first < frames;) {
    // A last batch of one frame would have no variance.
    const std::uint32_t rest = frames - first, now = rest < batch + 2 ? rest : batch;
    append(all, engine->render(first, now));
    first += now;
    progress(static_cast<double>(first) / frames);
  }
  return all;
}

std::vector<Case> closed_form_cases(const PictureSources& sources, std::uint64_t samples) {
  std::vector<Case> cases;
  for (const ClosedFormInfo& info : closed_forms()) cases.push_back(case_of(info, sources, samples));
  return cases;
}

}  // namespace plumbline
