// SPDX-License-Identifier: MIT
// Walks a geometry image on the CPU, link by link as the shader does, once entering every node and once none.
#include <array>
#include <bit>
#include <cmath>
#include <string>

#include "tracer/geometry_image.h"

namespace plumbline {
namespace {

/// What a walk met.
struct Tour {
  std::vector<std::uint32_t> visits;  ///< of each stored primitive
  std::uint32_t nodes = 0;            ///< visited, as the shader counts them
  std::string error;                  ///< empty where the walk ended in order
};

class Tourist {
 public:
  Tourist(const GeometryImage& image, unsigned copy, bool enter) : image_(image), copy_(copy), enter_(enter) {}

  Tour walk() {
    tour_.visits.assign(image_.primitive_count, 0);
    if (image_.options.layout == Layout::compact) {
      walk_compact();
    } else {
      walk_paper();
    }
    return tour_;
  }

 private:
  bool fail(const std::string& what) {
    tour_.error = "copy " + std::to_string(copy_) + ": " + what;
    return false;
  }
  /// Counts a node; false where the walk is too long already.
  bool count_node() {
    return ++tour_.nodes <= image_.cell_count || fail("the walk does not end within the number of nodes");
  }

  bool visit_cluster(std::uint64_t k) {
    for (;; ++k) {
      if (k >= image_.primitive_count) return fail("a cluster runs past the last primitive");
      ++tour_.visits[k];
      if (label(k) < 0.0f) return true;
    }
  }
  float label(std::uint64_t k) const {
    const std::uint64_t place = image_.primitive_start + k * image_.primitive_stride;
    if (image_.options.layout == Layout::compact) return image_.texels[place].w;
    return cell(place)[0].w;
  }

  void walk_compact() {
    const std::uint64_t begin = std::uint64_t{copy_} * image_.copy_size, end = begin + image_.copy_size;
    const std::uint32_t node_texels = image_.options.bounds == Bounds::aabb ? 2 : 1;
    for (std::uint64_t at = begin;;) {
      if (at >= end) return void(fail("a link leads out of the copy"));
      if (!count_node()) return;
      const std::uint32_t word = std::bit_cast<std::uint32_t>(image_.texels[at].w);
      if (word == kEndWord) return;
      const std::uint32_t payload = word & ((1u << image_.payload_bits) - 1u);
      const bool leaf = word >> 31 != 0;
      if (leaf && enter_ && !visit_cluster(payload)) return;
      if (!leaf && payload < node_texels) return void(fail("a node leads to itself"));
      at += leaf || enter_ ? node_texels : payload;
    }
  }

  /// The two texels of a cell.
  const glm::vec4* row(std::uint64_t c, int below) const {
    const std::uint64_t width = static_cast<std::uint64_t>(image_.width);
    return &image_.texels[(c / width * 2 + static_cast<std::uint64_t>(below)) * width + c % width];
  }
  std::array<glm::vec4, 2> cell(std::uint64_t c) const { return {*row(c, 0), *row(c, 1)}; }
  /// The cell that a link leads to; false where it leads nowhere.
  bool follow(glm::vec2 link, std::uint64_t& place) {
    const double x = (link.x - std::floor(link.x)) * image_.width - 0.5, y = (link.y * image_.height - 0.5) / 2.0;
    const double cells = static_cast<double>(image_.width) * image_.height / 2.0;
    const double number = y * image_.width + x;
    if (!(number >= 0.0 && number < cells) || number != std::floor(number))
      return fail("a link does not lead to a cell");
    place = static_cast<std::uint64_t>(number);
    return true;
  }

  void walk_paper() {
    std::uint64_t at = std::uint64_t{copy_} * image_.copy_size;
    for (;;) {
      if (!count_node()) return;
      const glm::vec4 links = cell(at)[1];
      glm::vec2 next(links);
      if (!enter_ || next.x >= 0.0f) {
        if (!enter_) next = glm::vec2(links.z, links.w);
      } else if (std::floor(next.x) > static_cast<float>(kLinkEnd)) {
        std::uint64_t place = 0;
        if (!follow(next, place)) return;
        if (place < image_.primitive_start) return void(fail("a link to primitives leads to nodes"));
        if (!visit_cluster((place - image_.primitive_start) / image_.primitive_stride)) return;
        next = glm::vec2(links.z, links.w);
      }
      if (std::floor(next.x) == static_cast<float>(kLinkEnd)) return;
      if (next.x < 0.0f || !follow(next, at)) return void(fail("an out link leads to something that is no node"));
    }
  }

  const GeometryImage& image_;
  const unsigned copy_;
  const bool enter_;
  Tour tour_;
};

}  // namespace

std::vector<std::string> verify(const GeometryImage& image) {
  std::vector<std::string> findings;
  for (unsigned copy = 0; copy < image.copy_count; ++copy) {
    const Tour in = Tourist(image, copy, true).walk();
    if (!in.error.empty()) {
      findings.push_back(in.error);
    } else if (in.nodes != image.cell_count) {
      findings.push_back("copy " + std::to_string(copy) + ": entering every node, the walk visits " +
                         std::to_string(in.nodes) + " of " + std::to_string(image.cell_count));
    } else {
      std::size_t missed = 0, repeated = 0;
      for (const std::uint32_t visits : in.visits) missed += visits == 0, repeated += visits > 1;
      const std::string where = "copy " + std::to_string(copy) + ": ";
      if (missed > 0) findings.push_back(where + std::to_string(missed) + " primitives stand in no leaf");
      if (repeated > 0) findings.push_back(where + std::to_string(repeated) + " primitives stand in several leaves");
    }
    const Tour out = Tourist(image, copy, false).walk();
    if (!out.error.empty()) findings.push_back(out.error + " (entering no node)");
  }
  return findings;
}

}  // namespace plumbline
