// SPDX-License-Identifier: MIT
#include "reports/plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reports/files.h"
#include "reports/format.h"
#include "reports/picture.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

constexpr double kWidth = 640.0, kHeight = 400.0;
constexpr double kLeft = 74.0, kRight = 14.0, kTop = 14.0, kBottom = 52.0;
constexpr double kLegendLine = 18.0;

/// One axis: values to shares of its length, and where its ticks stand.
struct Axis {
  bool log = false;
  double low = 0.0, high = 1.0;  ///< of the shown range; exponents of ten where log
  std::vector<double> ticks;     ///< values

  double share(double value) const { return ((log ? std::log10(value) : value) - low) / (high - low); }
};

/// A round step that cuts `range` into four to ten parts.
double round_step(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 4.0)));
  for (const double factor : {5.0, 2.0})
    if (range / (factor * power) >= 4.0) return factor * power;
  return power;
}

Axis make_axis(bool log, const std::vector<double>& values) {
  Axis axis;
  axis.log = log;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double v : values) {
    if (!std::isfinite(v) || (log && !(v > 0.0))) continue;
    low = std::min(low, log ? std::log10(v) : v);
    high = std::max(high, log ? std::log10(v) : v);
  }
  if (!(low <= high)) low = 0.0, high = 1.0;
  if (!log) low = std::min(low, 0.0);
  if (!(low < high)) low -= 0.5, high += 0.5;
  if (log) {
    // Powers of two where the range is short, of ten where it is long.
    const double base = high - low < 3.5 ? 2.0 : 10.0, step = std::log10(base);
    axis.low = step * std::floor(low / step + 1e-9), axis.high = step * std::ceil(high / step - 1e-9);
    const int first = static_cast<int>(std::lround(axis.low / step)),
              last = static_cast<int>(std::lround(axis.high / step));
    for (int i = first; i <= last; ++i) axis.ticks.push_back(std::pow(base, i));
  } else {
    const double step = round_step(high - low);
    axis.low = step * std::floor(low / step + 1e-9), axis.high = step * std::ceil(high / step - 1e-9);
    for (int i = 0; axis.low + i * step <= axis.high + 0.5 * step; ++i) axis.ticks.push_back(axis.low + i * step);
  }
  return axis;
}

std::string number(double value) { return fixed(value, 1); }

std::string text_at(double x, double y, const char* anchor, const std::string& text, const std::string& more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
         xml_escape(text) + "</text>\n";
}

std::string line_between(double x1, double y1, double x2, double y2, const char* color) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" + number(y2) +
         "\" stroke=\"" + color + "\"/>\n";
}

std::string mark_at(const std::string& x, const std::string& y, const std::string& color) {
  return "<circle cx=\"" + x + "\" cy=\"" + y + "\" r=\"3\" fill=\"" + xml_escape(color) + "\"/>\n";
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  std::vector<double> xs, ys;
  for (const PlotSeries& s : plot.series) {
    PLUMBLINE_ASSERT(s.x.size() == s.y.size());
    xs.insert(xs.end(), s.x.begin(), s.x.end());
    PLUMBLINE_ASSERT(s.low.size() == s.high.size() && (s.low.empty() || s.low.size() == s.y.size()));
    for (const auto* values : {&s.y, &s.low, &s.high}) ys.insert(ys.end(), values->begin(), values->end());
  }
  const Axis x = make_axis(plot.log_x, xs), y = make_axis(plot.log_y, ys);
  // Room for the label, and for the longest tick in letters of 7 units.
  std::size_t letters = 0;
  for (const double tick : y.ticks) letters = std::max(letters, value_text(tick).size());
  const double left = std::max(kLeft, 30.0 + 7.0 * static_cast<double>(letters));
  const double width = kWidth - left - kRight, height = kHeight - kTop - kBottom;
  const auto px = [&](double v) { return left + width * x.share(v); };
  const auto py = [&](double v) { return kTop + height * (1.0 - y.share(v)); };

  // A ground of its own: the page may be dark or light.
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 400\" width=\"640\" height=\"400\" "
      "font-family=\"sans-serif\" font-size=\"13\" fill=\"#222\">\n<rect width=\"640\" height=\"400\" "
      "fill=\"#fbfbf8\"/>\n";
  for (const double tick : x.ticks) {
    svg += line_between(px(tick), kTop, px(tick), kTop + height, "#ddd");
    svg += text_at(px(tick), kTop + height + 18.0, "middle", value_text(tick));
  }
  for (const double tick : y.ticks) {
    svg += line_between(left, py(tick), left + width, py(tick), "#ddd");
    svg += text_at(left - 6.0, py(tick) + 4.0, "end", value_text(tick));
  }
  svg += line_between(left, kTop + height, left + width, kTop + height, "#222");
  svg += line_between(left, kTop, left, kTop + height, "#222");
  svg += text_at(left + 0.5 * width, kHeight - 12.0, "middle", plot.x_label);
  svg += text_at(0.0, 0.0, "middle", plot.y_label,
                 " transform=\"translate(16 " + number(kTop + 0.5 * height) + ") rotate(-90)\"");

  double legend = kTop + 18.0;
  for (const PlotSeries& s : plot.series) {
    const std::string stroke =
        " stroke=\"" + xml_escape(s.color) + "\" stroke-width=\"2\"" + (s.dashed ? " stroke-dasharray=\"6 4\"" : "");
    std::string points, marks;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const bool shown = std::isfinite(s.x[i]) && std::isfinite(s.y[i]) && !(plot.log_x && !(s.x[i] > 0.0)) &&
                         !(plot.log_y && !(s.y[i] > 0.0));
      if (!shown) continue;
      const std::string at_x = number(px(s.x[i])), at_y = number(py(s.y[i]));
      points += (points.empty() ? "" : " ") + at_x + "," + at_y;
      if (s.marks) marks += mark_at(at_x, at_y, s.color);
      if (!s.low.empty() && std::isfinite(s.low[i]) && std::isfinite(s.high[i]) && !(plot.log_y && !(s.low[i] > 0.0)))
        marks += line_between(px(s.x[i]), py(s.low[i]), px(s.x[i]), py(s.high[i]), xml_escape(s.color).c_str());
    }
    if (s.line) svg += "<polyline fill=\"none\"" + stroke + " points=\"" + points + "\"/>\n";
    svg += marks;
    if (s.label.empty()) continue;
    if (s.line)
      svg += "<line x1=\"" + number(left + 12.0) + "\" y1=\"" + number(legend - 4.0) + "\" x2=\"" +
             number(left + 40.0) + "\" y2=\"" + number(legend - 4.0) + "\"" + stroke + "/>\n";
    else
      svg += mark_at(number(left + 26.0), number(legend - 4.0), s.color);
    svg += text_at(left + 46.0, legend, "start", s.label);
    legend += kLegendLine;
  }
  return svg + "</svg>\n";
}

PictureRecord save_plot(const Plot& plot, const std::filesystem::path& folder, const std::string& stem,
                        const std::string& title, const std::string& caption) {
  PictureRecord record;
  record.path = "pictures/" + picture_file_name(stem) + ".svg";
  record.title = title;
  record.caption = caption;
  record.width = static_cast<int>(kWidth);
  record.height = static_cast<int>(kHeight);
  write_text(folder / record.path, plot_svg(plot));
  return record;
}

}  // namespace plumbline
