// SPDX-License-Identifier: MIT
// How much larger the nodes' spheres are than they would have to be.
#include <algorithm>

#include "tracer/inspect_figures.h"
#include "tracer/miniball.h"
#include "tracer/tree_split.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

class RegionSlack {
 public:
  RegionSlack(const Examination& e, const RegionView& region) : e_(e), copy_(region.copies[0]) {
    // Balls in the order of the leaves, so that those below a node are one run. Without them: above parts of triangles
    // and above transforms, where what a sphere has to hold is not what stands in the image.
    const auto count = static_cast<std::uint32_t>(copy_.nodes.size());
    first_ball_.assign(count + 1, 0);
    excluded_.assign(count + 1, 0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const NodeView& node = copy_.nodes[i];
      if (node.is_leaf && node.payload < e.image.primitive_count) add_cluster(node.payload, excluded_[i + 1]);
      excluded_[i + 1] += excluded_[i] + (node.is_leaf && node.payload >= e.image.primitive_count ? 1 : 0);
      first_ball_[i + 1] = static_cast<std::uint32_t>(balls_.size());
    }
    supports_.resize(count);
    ratio_.assign(count, 0.0);
  }

  /// Of each node.
  std::vector<double> measure() {
    const auto count = static_cast<std::uint32_t>(copy_.nodes.size());
    // Subtrees of a sixteenth at most are tasks; what stands above them comes after.
    std::vector<std::uint32_t> tasks;
    const std::uint32_t most = std::max(count / 16, 1000u);
    std::vector<bool> is_done(count, false);
    for (std::uint32_t i = 0; i < count;) {
      const std::uint32_t size = copy_.nodes[i].end - i;
      if (size <= most) tasks.push_back(i);
      i = size <= most ? copy_.nodes[i].end : i + 1;
    }
    parallel_for(tasks.size(), count > 5000 ? e_.threads : 1, [&](std::size_t task) {
      for (std::uint32_t i = copy_.nodes[tasks[task]].end; i-- > tasks[task];) fit(i);
    });
    for (const std::uint32_t task : tasks)
      for (std::uint32_t i = task; i < copy_.nodes[task].end; ++i) is_done[i] = true;
    for (std::uint32_t i = count; i-- > 0;)
      if (!is_done[i]) fit(i);
    return std::move(ratio_);
  }

 private:
  void add_cluster(std::uint32_t k, std::uint32_t& excluded) {
    for (const std::uint32_t end = cluster_end(e_, k); k < end; ++k) {
      const StoredPrimitive p = stored_primitive(e_.image, k);
      if (e_.is_shared[k]) ++excluded;
      balls_.push_back({p.a, p.radius});
      if (p.is_triangle) balls_.push_back({p.b, 0.0f}), balls_.push_back({p.c, 0.0f});
    }
  }

  void fit(std::uint32_t i) {
    const NodeView& node = copy_.nodes[i];
    const std::uint32_t first = first_ball_[i], end = first_ball_[node.end];
    if (first == end || excluded_[node.end] != excluded_[i]) return;
    std::vector<std::uint32_t> start;
    for (std::uint32_t c = i + 1; c < node.end; c = copy_.nodes[c].end)
      for (int s = 0; s < supports_[c].count; ++s) start.push_back(supports_[c].ball[s] - first);
    const std::span<const FloatBall> balls(balls_.data() + first, end - first);
    const Volume volume = volume_at(e_.image, node_unit(e_, copy_, i));
    const double radius = std::sqrt(static_cast<double>(volume.radius2));
    double least = enclosing_radius(balls, glm::vec3(smallest_ball_center(balls, start, supports_[i])));
    // A larger ball than one that is known to hold everything is not the smallest: the way from those supports was a
    // dead end.
    if (least > radius) least = enclosing_radius(balls, glm::vec3(smallest_ball_center(balls, {}, supports_[i])));
    for (int s = 0; s < supports_[i].count; ++s) supports_[i].ball[s] += first;
    if (least > 0.0) ratio_[i] = radius / least;
  }

  const Examination& e_;
  const CopyView& copy_;
  std::vector<FloatBall> balls_;
  std::vector<std::uint32_t> first_ball_;  ///< of each node, and the end
  std::vector<std::uint32_t> excluded_;    ///< running sum
  std::vector<BallSupport> supports_;      ///< indices into balls_
  std::vector<double> ratio_;              ///< 0: none
};

}  // namespace

std::vector<double> node_slack(const Examination& e, const RegionView& region) {
  return RegionSlack(e, region).measure();
}

void measure_slack(Examination& e) {
  if (has_boxes(e.image) || e.recorder.count() > 0) return;  // broken clusters would be no clusters
  std::vector<double> ratios;
  for (const RegionView& region : e.regions)
    for (const double ratio : node_slack(e, region))
      if (ratio > 0.0) ratios.push_back(ratio);
  if (ratios.empty()) return;
  const Summary summary = summarize_values(std::move(ratios));
  e.certificate.slack = {summary.min, summary.median, summary.max, summary.count};
}

}  // namespace plumbline
