// SPDX-License-Identifier: MIT
// The certificate from end to end: the rules by name, the attributes, and the order in which the parts look.
#include "tracer/verify.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>
#include <tuple>

#include "scenes/error.h"
#include "tracer/verify_examination.h"

namespace plumbline {
namespace {

using Needs = VerifyRule::Needs;

constexpr VerifyRule kRules[] = {
    {"metadata", "sizes, counts and the longest walk, as the attributes tell them, are those of the texels",
     "the shader is sent to texels that hold something else, or cuts walks off before their end"},
    {"link_target", "every link lands on the centre of a cell of a kind that is legal there",
     "a ray that takes it walks on in something else, or leaves out what it should have tested"},
    {"chain_end", "a chain that would end is ended at once, and nothing else ends",
     "a ray ends its walk early and loses what comes after, or walks on behind the end"},
    {"cycle", "no link leads back, and no space stands within itself",
     "a ray that takes it walks in a circle until the cap and is reported as capped"},
    {"no_end", "walks that enter everything and walks that enter nothing end at the end of their copy",
     "a ray leaves the copy and walks on in another, or until the cap"},
    {"unreached", "every cell that holds something is reached from the root",
     "a ray misses what stands there, whatever it aims at"},
    {"visited_twice", "a walk that enters everything visits each leaf and each primitive exactly once",
     "primitives are tested again: steps are lost, and where a way out leads back to one place of two, answers"},
    {"copies", "all copies of a region hold the same nodes",
     "rays of one octant of directions may lose what rays of the others find, or take more steps"},
    {"thread", "what is threaded equals the walk of the tree on the CPU, front to back in every octant",
     "rays take another way than the tree's: they lose what is left out, or take more steps", Needs::tree},
    {"containment", "every bounding volume contains everything below it, transforms included",
     "a ray that hits what sticks out is rejected by the volume and misses it"},
    {"padding", "bounding volumes hold what lies below them by at least what the shader's rounding needs",
     "a ray that grazes the volume where it hits something below may be rejected by rounding alone"},
    {"ball", "the balls that far rays are moved near to contain what stands there",
     "a far ray may be told to miss, or starts its walk behind what it hits"},
    {"transform_balance", "each way into a transform has its way out, in every copy",
     "a ray that leaves the transform goes on with another space or at another place: it loses what comes after"},
    {"record", "a transform's record tells what stands behind it and how deep",
     "a ray enters something else, or leaves through too few or too many spaces"},
    {"inverse", "inverse times matrix is the identity within what rounding to float may do",
     "what is hit behind the transform is found in one place and reported in another"},
    {"label",
     "labels are whole numbers, negative on the last of each cluster and on no other; kinds and radii are legal",
     "a ray tests too few or too many primitives at a leaf, or reports another primitive"},
    {"word", "a node's word has no bits beside radius, payload and leaf",
     "a node of a later format is taken for one of this"},
    {"texel_nan", "no texel is NaN or infinite",
     "comparisons with it fail: a ray is rejected, or lets nothing pass, whatever it aims at"},
    {"texel_denormal", "no number is denormal unless the scene itself has it",
     "drivers that flush denormals to zero see another number"},
    {"texel_unused", "texels and components that mean nothing are zero",
     "no ray reads it; whoever wrote it meant something that is not there"},
    {"primitive_bits", "primitives equal the scene's bit for bit, times the space's exact power of two",
     "a ray hits something that stands elsewhere or bears another name", Needs::scene},
    {"primitive_missing", "every primitive with an area or a radius that the scene places stands in its space",
     "a ray that hits it in the scene misses it here", Needs::scene},
    {"matrix_bits", "matrices equal the scene's, their inverses what double precision makes of them",
     "what stands behind the transform is seen elsewhere than in the scene", Needs::scene},
    {"light_bits", "lights equal the scene's bit for bit, in its order",
     "a surface is lit from elsewhere, in another colour, or not at all", Needs::scene},
};
static_assert(std::size(kRules) == static_cast<std::size_t>(Rule::light_bits) + 1);

bool is_power_of_two(int n) { return n > 0 && n <= kMaxImageWidth && std::has_single_bit(static_cast<unsigned>(n)); }

}  // namespace

std::span<const VerifyRule> verify_rules() { return kRules; }

std::string shown(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

void leave_undecided(const Examination& e, std::initializer_list<Rule> rules) {
  for (const Rule rule : rules) e.certificate.undecided.emplace(kRules[static_cast<std::size_t>(rule)].name);
}

std::uint64_t Recorder::rule_count(Rule rule) const {
  const auto at = static_cast<std::size_t>(rule);
  return at < counts_.size() ? counts_[at] : 0;
}

void Recorder::add_at(Rule rule, int x, int y, std::uint32_t node, std::string message) {
  const auto at = static_cast<std::size_t>(rule);
  counts_.resize(std::size(kRules), 0);
  ++total_;
  if (++counts_[at] > kMaxFindings) return;
  entries_.push_back({rule, {std::string(kRules[at].name), x, y, node, std::move(message), kRules[at].effect}});
}

void Recorder::add(Rule rule, std::size_t texel, std::uint32_t node, std::string message) {
  const std::size_t width = static_cast<std::size_t>(image_->width);
  const auto x = static_cast<int>(texel % width), y = static_cast<int>(texel / width);
  add_at(rule, x, is_compact(*image_) ? y : y & ~1, node, std::move(message));
}

void Recorder::merge(Recorder&& other) {
  counts_.resize(std::size(kRules), 0);
  std::vector<std::uint64_t> kept = counts_;
  for (Entry& entry : other.entries_)
    if (++kept[static_cast<std::size_t>(entry.rule)] <= kMaxFindings) entries_.push_back(std::move(entry));
  for (std::size_t i = 0; i < other.counts_.size(); ++i) counts_[i] += other.counts_[i];
  total_ += other.total_;
}

void Recorder::finish(Certificate& certificate) {
  std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::tuple(a.rule, a.finding.y, a.finding.x) < std::tuple(b.rule, b.finding.y, b.finding.x);
  });
  for (Entry& entry : entries_) certificate.findings.push_back(std::move(entry.finding));
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if (counts_[i] > 0) certificate.counts[std::string(kRules[i].name)] = counts_[i];
}

std::vector<std::string> attribute_errors(const GeometryImage& image) {
  std::vector<std::string> errors;
  const auto demand = [&](bool holds, const std::string& message) {
    if (!holds) errors.push_back(message);
  };
  const auto count = [](std::uint64_t value) { return std::to_string(value); };
  if (!is_power_of_two(image.width) || !is_power_of_two(image.height))
    return {"the image is " + std::to_string(image.width) + " x " + std::to_string(image.height) +
            " texels, but sides are powers of two up to 16384"};
  const std::uint64_t texels = static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
  const std::uint64_t units = is_compact(image) ? texels : texels / 2;
  demand(image.copy_count == (image.options.links == Links::octant ? 8u : 1u),
         count(image.copy_count) + " copies do not go with links `" + name_of(image.options.links) + "`");
  demand(image.payload_bits >= 0 && image.payload_bits <= kMaxPayloadBits,
         "payloads of " + std::to_string(image.payload_bits) + " bits, but words have up to 23");
  demand(image.primitive_stride ==
             primitive_stride(image.options.layout, image.triangle_count > 0 || image.sphere_count == 0),
         "primitives of " + count(image.primitive_stride) + " units do not go with " + count(image.triangle_count) +
             " triangles and " + count(image.sphere_count) + " spheres");
  demand(image.copy_size > 0 && std::uint64_t{image.copy_count} * image.copy_size <= image.primitive_start,
         "the world's copies of " + count(image.copy_size) + " do not fit before the primitives at " +
             count(image.primitive_start));
  const std::uint64_t behind = image.primitive_start + std::uint64_t{image.primitive_stride} * image.primitive_count;
  demand(image.transform_start == behind, "transforms are said to start at " + count(image.transform_start) +
                                              ", but primitives end at " + count(behind));
  demand(behind + std::uint64_t{record_units(image)} * image.transform_count +
                 std::uint64_t{light_units(image)} * image.light_count <=
             units,
         "there are fewer texels than the attributes promise: primitives, transforms and lights run past unit " +
             count(units));
  demand(image.world_primitives <= image.primitive_count,
         count(image.world_primitives) + " of " + count(image.primitive_count) + " primitives stand in the world");
  demand(image.primitive_count <= kMaxPrimitives && image.transform_count < kMaxExactFloat,
         "more primitives or transforms than floats can number");
  demand(image.options.layout == Layout::paper || image.payload_bits > kMaxPayloadBits || image.payload_bits < 0 ||
             std::uint64_t{image.primitive_count} + image.transform_count < (std::uint64_t{1} << image.payload_bits) ||
             image.primitive_count + image.transform_count == 0,
         "payloads of " + std::to_string(image.payload_bits) + " bits cannot number " + count(image.primitive_count) +
             " primitives and " + count(image.transform_count) + " transforms");
  const bool is_finite = std::isfinite(image.center.x) && std::isfinite(image.center.y) &&
                         std::isfinite(image.center.z) && std::isfinite(image.radius) && image.radius >= 0.0f;
  demand(is_finite, "the scene's ball is not finite");
  demand(image.scale_exponent >= -300 && image.scale_exponent <= 300,
         "the scale is 2^" + std::to_string(image.scale_exponent) + ", but must lie from 2^-300 to 2^300");
  return errors;
}

bool check_metadata(Examination& e) {
  for (const std::string& error : attribute_errors(e.image)) e.recorder.add(Rule::metadata, error);
  if (e.recorder.count() == 0 &&
      e.image.texels.size() != static_cast<std::uint64_t>(e.image.width) * static_cast<std::uint64_t>(e.image.height))
    e.recorder.add(Rule::metadata,
                   "the image has " + std::to_string(e.image.texels.size()) + " texels, not its width by its height");
  return e.recorder.count() == 0;
}

Certificate certify(const GeometryImage& image, const Scene* scene, const SceneTree* tree, int threads) {
  const auto start = std::chrono::steady_clock::now();
  if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  Certificate certificate;
  Examination e{image, scene, scene != nullptr ? tree : nullptr, threads, certificate, Recorder(image), {}, {}, {}, {},
                {},    {}};
  if (check_metadata(e)) {
    check_links(e);
    check_copies(e);
    check_clusters(e);
    check_texels(e);
    check_records(e);
    check_bounds(e);
    check_spaces(e);
    if (e.scene != nullptr) check_scene(e);
    if (e.tree != nullptr) check_tree(e);
    measure_slack(e);
  } else {
    for (const VerifyRule& rule : kRules)
      if (rule.needs == Needs::image   ? rule.name != "metadata"
          : rule.needs == Needs::scene ? e.scene != nullptr
                                       : e.tree != nullptr)
        certificate.undecided.emplace(rule.name);
  }
  e.recorder.finish(certificate);
  certificate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

}  // namespace plumbline
