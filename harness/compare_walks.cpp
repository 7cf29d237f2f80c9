// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/compare_walks.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <tuple>

#include "harness/walk_record.h"
#include "tracer/image_structure.h"
#include "tracer/image_view.h"

namespace plumbline {
namespace {

/// Bits of what stands below a node: the sum of a hash of each primitive and transform, so that order does not matter.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// The sums of one copy of a region, leaf by leaf.
class Below {
 public:
  explicit Below(const GeometryImage& image) : image_(image) {}

  /// Of the node that a step visited; 0 where it is none.
  std::uint64_t of(const WalkStep& step) {
    if (step.copy == kNone || step.test == NodeTest::end) return 0;
    const auto key = std::pair(step.space, step.copy);
    auto found = sums_.find(key);
    if (found == sums_.end()) found = sums_.emplace(key, sums_of(step.space, step.copy)).first;
    const std::vector<std::uint64_t>& sums = found->second;
    if (step.node + 1 >= sums.size()) return 0;
    const auto copy = region_copy(image_, step.space, step.copy);
    const NodeCell node = node_cell(image_, step.cell);
    std::size_t end = step.node + 1;
    if (!node.is_leaf)
      end = node.out != kNone && node.out > step.cell && node.out <= copy->end
                ? (node.out - copy->begin) / node_units(image_)
                : sums.size() - 1;
    return sums[std::min(end, sums.size() - 1)] - sums[step.node];
  }

 private:
  std::vector<std::uint64_t> sums_of(std::uint32_t space, std::uint32_t copy_number) const {
    std::vector<std::uint64_t> sums{0};
    const auto copy = region_copy(image_, space, copy_number);
    if (!copy) return sums;
    for (std::uint32_t cell = copy->begin; cell < copy->end; cell += node_units(image_)) {
      const NodeCell node = node_cell(image_, cell);
      std::uint64_t sum = 0;
      if (node.is_leaf && node.transform != kNone) sum = mixed((std::uint64_t{1} << 40) + node.transform);
      for (std::uint32_t k = node.cluster; node.is_leaf && k < image_.primitive_count; ++k) {
        const float label = texel_at(image_, primitive_unit(image_, k)).w;
        sum += mixed(primitive_of_label(label).value_or(kNone) + 1ull);
        if (!(label > 0.0f)) break;
      }
      sums.push_back(sums.back() + sum);
    }
    return sums;
  }

  const GeometryImage& image_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint64_t>> sums_;
};

/// A test, and the step at which it was made.
struct Test {
  std::tuple<std::uint32_t, std::uint64_t, std::string> what;  ///< space, node or primitive, outcome
  std::string says;
  std::size_t step = 0;
};

std::string behind(std::uint32_t space) {
  return space == kNone ? std::string() : " behind transform " + std::to_string(space);
}

std::vector<Test> primitive_tests(const Walk& walk) {
  std::vector<Test> tests;
  for (std::size_t i = 0; i < walk.steps.size(); ++i) {
    const WalkStep& step = walk.steps[i];
    for (const TestedPrimitive& p : step.primitives) {
      if (p.outcome == PrimitiveTest::edge_on) continue;  // it is resolved next
      char t[32];
      std::snprintf(t, sizeof t, " at t = %.9g", static_cast<double>(p.t));
      const std::string outcome =
          std::string(name_of(p.outcome)) + (p.outcome == PrimitiveTest::outside ? std::string() : std::string(t));
      tests.push_back({{step.space, p.primitive, outcome},
                       "primitive " + std::to_string(p.primitive) + behind(step.space) + ": " + outcome,
                       i});
    }
  }
  return tests;
}

std::vector<Test> node_tests(const Walk& walk, const GeometryImage& image) {
  Below below(image);
  std::vector<Test> tests;
  for (std::size_t i = 0; i < walk.steps.size(); ++i) {
    const WalkStep& step = walk.steps[i];
    if (step.test == NodeTest::end || step.again) continue;
    const std::uint64_t sum = below.of(step);
    // Spheres and boxes tell misses apart in their own ways; what counts is who is entered.
    const std::string outcome = step.test == NodeTest::hit ? "entered" : "rejected";
    tests.push_back(
        {{step.space, sum, outcome},
         "cell (" + std::to_string(step.x) + ", " + std::to_string(step.y) + ")" + behind(step.space) + ": " + outcome,
         i});
  }
  return tests;
}

/// Index of the first difference; the shorter one's length where it is the beginning of the other.
std::size_t first_difference(const std::vector<Test>& a, const std::vector<Test>& b) {
  std::size_t i = 0;
  while (i < a.size() && i < b.size() && a[i].what == b[i].what) ++i;
  return i;
}

void compare_lists(const char* kind, const std::vector<Test>& a, const std::vector<Test>& b, const Walk& first,
                   const Walk& second, ComparisonRecord& out) {
  const std::size_t at = first_difference(a, b);
  if (at == a.size() && at == b.size()) return;
  const auto side = [&](const std::vector<Test>& tests) {
    return at < tests.size() ? tests[at].says : "has made all its " + std::to_string(tests.size()) + " tests";
  };
  out.same = false;
  out.sentence = std::string(kind) + " test " + std::to_string(at + 1) + " differs; the first: " + side(a) +
                 "; the second: " + side(b);
  if (at < a.size()) out.first = record_of(first.steps[a[at].step]);
  if (at < b.size()) out.second = record_of(second.steps[b[at].step]);
}

}  // namespace

ComparisonRecord compare_walks(const ComparedWalk& first, const ComparedWalk& second) {
  ComparisonRecord out;
  out.step_by_step = first.shape == second.shape;
  if (out.step_by_step) {
    out.note = "step by step, every number by its bits";
    if (const auto divergence = first_divergence(*first.walk, *second.walk)) {
      out.same = false;
      const std::size_t at = divergence->step;
      out.sentence = "step " + std::to_string(at + 1) + ": " + divergence->what;
      if (at < first.walk->steps.size()) out.first = record_of(first.walk->steps[at]);
      if (at < second.walk->steps.size()) out.second = record_of(second.walk->steps[at]);
    }
    return out;
  }
  const std::vector<Test> a = primitive_tests(*first.walk), b = primitive_tests(*second.walk);
  if (first.image != nullptr && second.image != nullptr) {
    out.note =
        "the images are built otherwise: compared are the order of node tests, each node known by what stands "
        "below it, and of primitive tests, and their outcomes";
    compare_lists("node", node_tests(*first.walk, *first.image), node_tests(*second.walk, *second.image), *first.walk,
                  *second.walk, out);
    if (!out.same) {
      // Where trees differ, nodes do from the first; what was tested below may still be the same.
      ComparisonRecord primitives;
      compare_lists("primitive", a, b, *first.walk, *second.walk, primitives);
      out.sentence += primitives.same ? ". The primitives tested, " + std::to_string(a.size()) +
                                            ", their order and outcomes are the same"
                                      : ". " + primitives.sentence;
    }
  } else {
    out.note =
        "the images are built otherwise, and one is not at hand: compared are the order of primitive tests and "
        "their outcomes";
    compare_lists("primitive", a, b, *first.walk, *second.walk, out);
  }
  // What one tested and the other did not, in whatever order.
  const auto only_in = [](const std::vector<Test>& here, const std::vector<Test>& there) {
    std::map<std::pair<std::uint32_t, std::uint64_t>, int> known;
    for (const Test& t : there) ++known[{std::get<0>(t.what), std::get<1>(t.what)}];
    return std::count_if(here.begin(), here.end(), [&](const Test& t) {
      return !known.contains({std::get<0>(t.what), std::get<1>(t.what)});
    });
  };
  if (!out.same)
    out.sentence += ". Primitives that only the first tested: " + std::to_string(only_in(a, b)) +
                    ", only the second: " + std::to_string(only_in(b, a));
  return out;
}

}  // namespace plumbline
