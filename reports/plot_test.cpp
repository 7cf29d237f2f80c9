// SPDX-License-Identifier: MIT
// Plots: points stand where their values say, axes tell units, and nothing that cannot be shown is drawn.
#include "reports/plot.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "reports/files.h"

namespace plumbline {
namespace {

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("plot: points stand where their values say") {
  Plot plot{
      "depth (transforms)", "error <2^-24>", false, false, {{"inverse", "#d55e00", false, {0, 5, 10}, {0, 50, 100}}}};
  const std::string svg = plot_svg(plot);
  // The frame runs from (74, 14) to (626, 348).
  CHECK_THAT(svg, Catch::Contains("points=\"74.0,348.0 350.0,181.0 626.0,14.0\""));
  CHECK_THAT(svg, Catch::Contains(">depth (transforms)<"));
  CHECK_THAT(svg, Catch::Contains(">error &lt;2^-24&gt;<"));
  CHECK_THAT(svg, Catch::Contains(">inverse<"));
}

TEST_CASE("plot: logarithmic axes show decades, and leave out what has no logarithm") {
  Plot plot{"n", "e", true, true, {{"a", "#000000", true, {1, 10, 100, 1000, 10000, 0}, {1, 0, 100, NAN, 10000, 5}}}};
  const std::string svg = plot_svg(plot);
  CHECK(count_of(svg, "<circle") == 3);
  CHECK_THAT(svg, Catch::Contains("points=\"74.0,348.0 350.0,181.0 626.0,14.0\""));
  CHECK_THAT(svg, Catch::Contains("stroke-dasharray"));
}

TEST_CASE("plot: empty and constant series make a plot all the same") {
  CHECK_THAT(plot_svg({}), Catch::EndsWith("</svg>\n"));
  const std::string svg = plot_svg({"x", "y", true, true, {{"a", "#000000", false, {4}, {4}}}});
  CHECK(count_of(svg, "<circle") == 1);
  CHECK(count_of(svg, "nan") == 0);
  CHECK(count_of(svg, "inf") == 0);
}

TEST_CASE("plot: the record names the file that was written") {
  const auto folder = std::filesystem::temp_directory_path() / "plumbline_plot_test";
  std::filesystem::remove_all(folder);
  const PictureRecord record = save_plot({"x", "y", false, false, {}}, folder, "a b/c", "Title", "Caption.");
  CHECK(record.path == "pictures/a_b_c.svg");
  CHECK_THAT(read_text(folder / record.path), Catch::StartsWith("<svg "));
  std::filesystem::remove_all(folder);
}

TEST_CASE("plot: long ticks do not run into the label") {
  Plot plot{"samples", "error", false, true, {{"a", "#000000", false, {1.0, 2.0}, {0.0078125, 1.0}}}};
  const std::string svg = plot_svg(plot);
  const std::size_t tick = svg.find("0.007812");
  REQUIRE(tick != std::string::npos);
  // The tick ends where its text is anchored; its eight letters are 7 wide, the label's end at 22.
  const std::size_t at = svg.rfind("x=\"", tick) + 3;
  CHECK(std::stod(svg.substr(at)) - 8 * 7 >= 22.0);
}

}  // namespace plumbline
