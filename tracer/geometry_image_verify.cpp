// SPDX-License-Identifier: MIT
// Walks a geometry image on the CPU, link by link as the shader does, region by region, once entering every node and
// once none.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <set>
#include <string>

#include "tracer/geometry_image.h"

namespace plumbline {
namespace {

/// What a walk met.
struct Tour {
  std::vector<std::uint32_t> primitives;  ///< stored primitives, in the order of their visits
  std::vector<std::uint32_t> transforms;  ///< scene nodes whose leaves were met
  std::uint32_t nodes = 0;                ///< visited, as the shader counts them
  std::string error;                      ///< empty where the walk ended in order
};

/// What a region is walked from: texels (compact) or cells (paper).
struct Region {
  std::uint64_t start = 0, copy_size = 0;
};

class Tourist {
 public:
  Tourist(const GeometryImage& image, const Region& region, unsigned copy, bool enter)
      : image_(image), region_(region), copy_(copy), enter_(enter) {}

  Tour walk() {
    if (image_.options.layout == Layout::compact) {
      walk_compact();
    } else {
      walk_paper();
    }
    return tour_;
  }

 private:
  bool fail(const std::string& what) {
    tour_.error = "region at " + std::to_string(region_.start) + ", copy " + std::to_string(copy_) + ": " + what;
    return false;
  }
  /// Counts a node; false where the walk is too long already.
  bool count_node() {
    return ++tour_.nodes <= std::min<std::uint64_t>(image_.cell_count, region_.copy_size) ||
           fail("the walk does not end within the number of nodes");
  }

  bool visit_cluster(std::uint64_t k) {
    for (;; ++k) {
      if (k >= image_.primitive_count) return fail("a cluster runs past the last primitive");
      tour_.primitives.push_back(static_cast<std::uint32_t>(k));
      if (label(k) < 0.0f) return true;
    }
  }
  bool visit_transform(std::uint64_t n) {
    if (n >= image_.transform_count) return fail("a leaf leads to a transform that does not exist");
    tour_.transforms.push_back(static_cast<std::uint32_t>(n));
    return true;
  }
  float label(std::uint64_t k) const {
    const std::uint64_t place = image_.primitive_start + k * image_.primitive_stride;
    if (image_.options.layout == Layout::compact) return image_.texels[place].w;
    return cell(place)[0].w;
  }

  void walk_compact() {
    const std::uint64_t begin = region_.start + copy_ * region_.copy_size, end = begin + region_.copy_size;
    const std::uint32_t node_texels = image_.options.bounds == Bounds::aabb ? 2 : 1;
    for (std::uint64_t at = begin;;) {
      if (at >= end) return void(fail("a link leads out of the copy"));
      if (!count_node()) return;
      const std::uint32_t word = std::bit_cast<std::uint32_t>(image_.texels[at].w);
      if (word == kEndWord) return;
      const std::uint32_t payload = word & ((1u << image_.payload_bits) - 1u);
      const bool leaf = word >> 31 != 0;
      if (leaf && enter_ &&
          !(payload < image_.primitive_count ? visit_cluster(payload)
                                             : visit_transform(payload - image_.primitive_count)))
        return;
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
    std::uint64_t at = region_.start + copy_ * region_.copy_size;
    for (;;) {
      if (!count_node()) return;
      const glm::vec4 links = cell(at)[1];
      glm::vec2 next(links);
      if (!enter_ || next.x >= 0.0f) {
        if (!enter_) next = glm::vec2(links.z, links.w);
      } else if (std::floor(next.x) > static_cast<float>(kLinkEnd)) {
        std::uint64_t place = 0;
        if (!follow(next, place)) return;
        const bool transform = std::floor(next.x) == static_cast<float>(kLinkTransform);
        const std::uint64_t base = transform ? image_.transform_start : image_.primitive_start;
        if (place < base) return void(fail("a link to primitives or transforms leads elsewhere"));
        if (!(transform ? visit_transform((place - base) / (kTransformTexels / 2))
                        : visit_cluster((place - base) / image_.primitive_stride)))
          return;
        next = glm::vec2(links.z, links.w);
      }
      if (std::floor(next.x) == static_cast<float>(kLinkEnd)) return;
      if (next.x < 0.0f || !follow(next, at)) return void(fail("an out link leads to something that is no node"));
    }
  }

  const GeometryImage& image_;
  const Region region_;
  const unsigned copy_;
  const bool enter_;
  Tour tour_;
};

}  // namespace

std::vector<std::string> verify(const GeometryImage& image) {
  std::vector<std::string> findings;
  std::vector<Region> regions{{0, image.copy_size}};
  std::set<std::uint64_t> starts{0};
  std::vector<std::uint32_t> seen_primitives(image.primitive_count, 0), seen_transforms(image.transform_count, 0);
  // Regions are found behind the transforms that lead to them, each is walked once.
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (unsigned copy = 0; copy < image.copy_count; ++copy) {
      Tour in = Tourist(image, regions[r], copy, true).walk();
      if (!in.error.empty()) {
        findings.push_back(in.error);
        continue;
      }
      const std::uint64_t size = image.options.bounds == Bounds::aabb ? 2 : 1;
      const bool compact = image.options.layout == Layout::compact;
      const std::uint64_t nodes = compact ? (regions[r].copy_size - 1) / size + 1 : regions[r].copy_size / size;
      if (in.nodes != nodes)
        findings.push_back("region at " + std::to_string(regions[r].start) + ", copy " + std::to_string(copy) +
                           ": entering every node, the walk visits " + std::to_string(in.nodes) + " of " +
                           std::to_string(nodes));
      const Tour out = Tourist(image, regions[r], copy, false).walk();
      if (!out.error.empty()) findings.push_back(out.error + " (entering no node)");
      if (copy == 0) {
        for (const std::uint32_t k : in.primitives) ++seen_primitives[k];
        for (const std::uint32_t n : in.transforms) {
          ++seen_transforms[n];
          const Region behind{static_cast<std::uint64_t>(image.texels[transform_texel(image, n, 4)].w),
                              static_cast<std::uint64_t>(image.texels[transform_texel(image, n, 5)].w)};
          if (behind.copy_size == 0 || behind.start + image.copy_count * behind.copy_size > image.primitive_start)
            findings.push_back("transform " + std::to_string(n) + " leads to no region");
          else if (starts.insert(behind.start).second)
            regions.push_back(behind);
        }
        continue;
      }
      const Tour first = Tourist(image, regions[r], 0, true).walk();
      const auto same = [](std::vector<std::uint32_t> a, std::vector<std::uint32_t> b) {
        std::sort(a.begin(), a.end()), std::sort(b.begin(), b.end());
        return a == b;
      };
      if (!same(in.primitives, first.primitives) || !same(in.transforms, first.transforms))
        findings.push_back("region at " + std::to_string(regions[r].start) + ", copy " + std::to_string(copy) +
                           ": holds other things than copy 0");
    }
  }
  std::size_t missed = 0, repeated = 0;
  for (const std::uint32_t visits : seen_primitives) missed += visits == 0, repeated += visits > 1;
  if (missed > 0) findings.push_back(std::to_string(missed) + " primitives stand in no leaf");
  if (repeated > 0) findings.push_back(std::to_string(repeated) + " primitives stand in several leaves");
  for (std::uint32_t n = 0; n < image.transform_count; ++n)
    if (seen_transforms[n] > 1) findings.push_back("transform " + std::to_string(n) + " stands in several leaves");
  return findings;
}

}  // namespace plumbline
