// SPDX-License-Identifier: MIT
// Rays go to a texture, one full-screen triangle per pass walks them, and what could not end within a pass goes on in
// another.
#include "tracer/probe.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "scenes/error.h"
#include "tracer/gl_objects.h"
#include "tracer/halves.h"
#include "tracer/pass.h"
#include "tracer/ray_order.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

constexpr std::size_t kBatch = std::size_t{kBatchWidth} * kBatchHeight;
// Primitives per brute-force pass: a quarter of the iterations that the driver's loops are known to survive.
constexpr std::uint32_t kBruteForceRange = 16384;

}  // namespace

struct Probe::Impl {
  using Clock = std::chrono::steady_clock;

  GlContext* context;
  Traversal traversal;
  int bundle = 1;
  std::vector<ShaderPatch> patches;
  std::vector<std::pair<ProgramVariant, GlProgram>> programs;
  GlTexture geometry, rays, state;
  bool is_counting = false;
  GlCounters visits;  // of the image at hand, where visits are counted
  std::array<GlTexture, kPassTargets> targets;
  GlFramebuffer plain_framebuffer, framebuffer;  // without the last target, with it
  std::vector<GlTexture> bundle_targets;         // of the rays of a bundle
  GlFramebuffer bundle_framebuffer;
  int target_count = kPassTargets - 1;
  // Of the image: what its programs are, how many primitives it has, and the constants of pass_constants.glsl.
  enum Pass { kFirst, kResume, kFinish };
  std::array<ProgramVariant, 3> variants;  // by pass; the last one ends what bundles have found
  std::uint32_t primitive_count = 0;
  PassConstants constants;
  std::uint64_t uploaded = 0;
  Ball world_ball;
  double seconds = 0.0, resumed_seconds = 0.0;
  int resumed = 0;
  std::uint64_t left_alone = 0;

  // Host copies of a batch.
  std::vector<glm::vec4> ray_texels;
  std::vector<PassWords> state_texels;
  std::array<std::vector<PassWords>, kPassTargets> results;
  std::vector<std::vector<PassWords>> bundle_results;

  Impl(GlContext& c, Traversal t, int rays_of_bundle, std::span<const ShaderPatch> p)
      : context(&c), traversal(t), bundle(rays_of_bundle), patches(p.begin(), p.end()) {
    PLUMBLINE_ASSERT(bundle >= 1 && bundle <= kMostBundled);
    ray_texels.resize(2 * kBatch);
    rays = GlTexture::linear(c, ray_texels);
    for (GlTexture& target : targets)
      target = GlTexture(c, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kBatchWidth, kBatchHeight);
    plain_framebuffer = GlFramebuffer(c, targets.data(), kPassTargets - 1);
    framebuffer = GlFramebuffer(c, targets.data(), kPassTargets);
    for (auto& result : results) result.resize(kBatch);
  }

  /// Targets of a bundle's pass; none where rays walk alone.
  int bundle_target_count() const {
    return bundle == 1 ? 0 : bundle == kBundleWithResults ? bundle * target_count : 2 * bundle;
  }

  /// The program of a variant, compiled when it is first asked for.
  const GlProgram& program(const ProgramVariant& variant) {
    for (const auto& [known, compiled] : programs) {
      if (known == variant) return compiled;
    }
    GlProgram compiled(*context,
                       link_program(*context, probe_vertex_shader(), probe_fragment_shader(variant, patches)));
    return programs.emplace_back(variant, std::move(compiled)).second;
  }

  void set_image(const GeometryImage& image) {
    require_fitting_image(*context, image);
    for (const bool thorough : {false, true}) {
      variants[thorough] = program_variant(image, traversal == Traversal::brute_force, thorough);
      variants[thorough].count_visits = is_counting;
    }
    variants[kFinish] = variants[kFirst];
    variants[kFinish].finish = true;
    variants[kFirst].bundle = bundle;
    program(variants[0]);
    geometry = {};  // the old image goes first: two large ones need not fit
    geometry = upload_image(*context, image);
    uploaded = image.texels.size();
    visits = {};
    if (is_counting) visits = GlCounters(*context, std::size_t{2} * std::max(image.primitive_start, 1u));
    set_constants(image);
  }

  void set_constants(const GeometryImage& image) {
    primitive_count = image.primitive_count;
    constants = pass_constants(image);
    target_count = image.transform_count > 0 ? kPassTargets : kPassTargets - 1;
    const int wanted = bundle_target_count();
    if (static_cast<int>(bundle_results.size()) != wanted) {
      while (static_cast<int>(bundle_targets.size()) < wanted)
        bundle_targets.emplace_back(*context, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kBatchWidth, kBatchHeight);
      bundle_framebuffer = GlFramebuffer(*context, bundle_targets.data(), wanted);
      bundle_results.resize(static_cast<std::size_t>(wanted));
    }
    const double to_world = std::ldexp(1.0, -image.scale_exponent);
    world_ball = {glm::dvec3(image.center) * to_world, image.radius * to_world};
  }

  /// Uploads what update_transforms has changed, and no other texels.
  void update(const GeometryImage& image, std::span<const TexelRange> changed) {
    set_constants(image);
    uploaded = update_texels(geometry, image, changed);
    context->check("updating the geometry image");
  }

  /// Puts a ray at a pixel of the batch.
  void put_ray(std::size_t pixel, const Ray& ray) {
    ray_texels[2 * pixel] = glm::vec4(ray.origin, ray.t_max);
    ray_texels[2 * pixel + 1] = glm::vec4(ray.direction, 0.0f);
  }
  /// Pixels that get no ray get one without direction, which ends at once.
  void clear_rays(int first_row, int end_row) {
    const std::ptrdiff_t row = 2 * kBatchWidth;
    std::fill(ray_texels.begin() + row * first_row, ray_texels.begin() + row * end_row, glm::vec4(0.0f));
  }

  void upload_state(int rows) {
    const GlFunctions& gl = context->use();
    if (!state)
      state =
          GlTexture(*context, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kPassTargets * kBatchWidth, kBatchHeight);
    state_texels.resize(static_cast<std::size_t>(target_count * kBatchWidth * rows));
    state.bind(kStateUnit);
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, target_count * kBatchWidth, rows, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                     state_texels.data());
  }

  /// One pass over the first rows of the batch: rays from ray_texels, results to `results`, or of bundles to
  /// `bundle_results`.
  void draw(int rows, Pass kind, std::uint32_t range_end) {
    const ProgramVariant& variant = variants[kind];
    const bool resume = kind != kFirst;
    const GlProgram& pass = program(variant);
    const GlFunctions& gl = context->use();
    const bool is_bundled = variant.bundle > 1;
    rays.update(std::span(ray_texels).first(static_cast<std::size_t>(2 * kBatchWidth * variant.bundle * rows)));
    geometry.bind(kGeometryUnit);
    rays.bind(kRayUnit);
    if (state) state.bind(kStateUnit);
    if (visits) visits.bind(0);
    pass.use();
    set_pass(pass, constants, {constants.scale_exponent, resume ? 1 : 0, static_cast<int>(range_end), 0});
    const GlFramebuffer& target = is_bundled                     ? bundle_framebuffer
                                  : target_count == kPassTargets ? framebuffer
                                                                 : plain_framebuffer;
    gl.BindFramebuffer(GL_FRAMEBUFFER, target.name());
    gl.Disable(GL_DITHER);
    const auto start = Clock::now();
    pass.draw(kBatchWidth, rows);
    gl.Finish();
    const double drawn = std::chrono::duration<double>(Clock::now() - start).count();
    seconds += drawn;
    if (resume) resumed_seconds += drawn;
    const int count = is_bundled ? bundle_target_count() : target_count;
    for (int i = 0; i < count; ++i) {
      std::vector<PassWords>& words =
          is_bundled ? bundle_results[static_cast<std::size_t>(i)] : results[static_cast<std::size_t>(i)];
      words.resize(kBatch);
      gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
      gl.ReadPixels(0, 0, kBatchWidth, rows, GL_RGBA_INTEGER, GL_UNSIGNED_INT, words.data());
    }
    context->check("tracing rays");
  }

  /// A ray of the batch whose walk has not ended, and the pixel where its state is.
  struct Open {
    std::uint32_t ray, pixel;
  };

  void trace_batch(std::span<const Ray> batch, std::span<Hit> hits) {
    const bool is_brute = traversal == Traversal::brute_force;
    const auto start = Clock::now();
    const RayPlaces places =
        place_rays(batch, is_brute ? RayOrder::groups : choose_ray_order(batch, world_ball), world_ball);
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    // No order leaves pixels without a ray in any but the last four rows.
    clear_rays(std::max(places.rows - 4, 0), places.rows);
    in_halves(batch.size(), [&](int, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) put_ray(places.pixel[i], batch[i]);
    });
    std::uint32_t range_end = is_brute ? kBruteForceRange : primitive_count;
    draw(places.rows, kFirst, range_end);

    std::array<std::vector<Open>, 2> open_of_half;
    in_halves(batch.size(), [&](int half, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i)
        take(static_cast<std::uint32_t>(i), places.pixel[i], hits, open_of_half[static_cast<std::size_t>(half)]);
    });
    std::vector<Open> open = std::move(open_of_half[0]);
    open.insert(open.end(), open_of_half[1].begin(), open_of_half[1].end());
    finish(batch, hits, std::move(open), range_end);
  }

  /// Rays of one pass: no order of their bundles needs more than eight rows beyond those that are full.
  std::size_t batch_rays() const {
    return bundle == 1 ? kBatch : std::size_t{kBatchWidth} * (kBatchHeight / bundle - 8) * bundle;
  }

  /// As trace_batch: a first pass walks the bundles. Where it does not write results, another makes hits of what they
  /// have found, and begins anew with the rays that were left alone.
  void trace_bundles(std::span<const Ray> batch, std::span<Hit> hits) {
    const auto size = static_cast<std::size_t>(bundle);
    const auto start = Clock::now();
    std::vector<Ray> first_rays;
    first_rays.reserve(batch.size() / size + 1);
    for (std::size_t i = 0; i < batch.size(); i += size) first_rays.push_back(batch[i]);
    const RayPlaces places = place_rays(first_rays, choose_ray_order(first_rays, world_ball), world_ball);
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    PLUMBLINE_ASSERT(places.rows * bundle <= kBatchHeight);
    clear_rays(std::max(places.rows - 4, 0) * bundle, places.rows * bundle);
    // The last bundle is filled up with its first ray.
    for (std::size_t i = 0; i < first_rays.size() * size; ++i)
      put_ray(places.pixel[i / size] * size + i % size, batch[i < batch.size() ? i : i - i % size]);
    draw(places.rows, kFirst, primitive_count);

    if (bundle == kBundleWithResults) {
      take_bundles(batch, hits, places);
      return;
    }

    // In the batch's order: what each ray's bundle has found becomes its hit.
    const int rows = static_cast<int>((batch.size() + kBatchWidth - 1) / kBatchWidth);
    clear_rays(rows - 1, rows);
    state_texels.resize(batch.size() * static_cast<std::size_t>(target_count));
    in_halves(batch.size(), [&](int, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        const std::size_t pixel = places.pixel[i / size], lane = i % size;
        const PassWords& a = bundle_results[2 * lane][pixel];
        const PassWords& b = bundle_results[2 * lane + 1][pixel];
        const bool is_alone = std::bit_cast<float>(a.y) < 0.0f;
        PassWords* words = &state_texels[i * static_cast<std::size_t>(target_count)];
        words[0] = {is_alone ? kStateNew : kStateEnded, target_count == kPassTargets ? b.z : a.x, a.w, 0u};
        words[1] = PassWords(0u);
        words[2] = {a.y, b.x, b.y, a.z};
        if (target_count == kPassTargets) words[3] = {a.x, b.w, ~0u, 0u};  // walks end in the world
        put_ray(i, batch[i]);
      }
    });
    upload_state(rows);
    draw(rows, kFinish, primitive_count);
    std::vector<Open> open;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      if (state_texels[i * static_cast<std::size_t>(target_count)].x == kStateEnded) {
        take(number, number, hits, open);
      } else {
        results[0][i] = PassWords(kStateNew, 0u, 0u, 0u);
        open.push_back({number, number});
      }
    }
    left_alone += open.size();
    finish(batch, hits, std::move(open), primitive_count);
  }

  /// Of bundles that have written results: those of rays that were left alone begin anew.
  void take_bundles(std::span<const Ray> batch, std::span<Hit> hits, const RayPlaces& places) {
    const auto size = static_cast<std::size_t>(bundle), count = static_cast<std::size_t>(target_count);
    std::array<std::vector<Open>, 2> open_of_half;
    in_halves(batch.size(), [&](int half, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        for (std::size_t k = 0; k < count; ++k)
          results[k][i] = bundle_results[i % size * count + k][places.pixel[i / size]];
        const auto number = static_cast<std::uint32_t>(i);
        take(number, number, hits, open_of_half[static_cast<std::size_t>(half)]);
      }
    });
    std::vector<Open> open = std::move(open_of_half[0]);
    open.insert(open.end(), open_of_half[1].begin(), open_of_half[1].end());
    left_alone += open.size();
    finish(batch, hits, std::move(open), primitive_count);
  }

  /// Goes on with the rays whose state is in `results`, pass by pass, until all of them have ended.
  void finish(std::span<const Ray> batch, std::span<Hit> hits, std::vector<Open> open, std::uint32_t range_end) {
    const bool is_brute = traversal == Traversal::brute_force;
    while (!open.empty()) {
      ++resumed;
      // In the order of their pixels, so that rays that walked together go on together.
      std::sort(open.begin(), open.end(), [](const Open& a, const Open& b) { return a.pixel < b.pixel; });
      state_texels.clear();
      const int rows = static_cast<int>((open.size() + kBatchWidth - 1) / kBatchWidth);
      clear_rays(rows - 1, rows);
      for (std::size_t k = 0; k < open.size(); ++k) {
        for (int i = 0; i < target_count; ++i)
          state_texels.push_back(results[static_cast<std::size_t>(i)][open[k].pixel]);
        put_ray(k, batch[open[k].ray]);
      }
      upload_state(rows);
      range_end = std::min(range_end + kBruteForceRange, std::uint32_t{1} << 30);
      draw(rows, kResume, range_end);
      std::vector<Open> still_open;
      for (std::size_t k = 0; k < open.size(); ++k) {
        // A pass that leaves everything as it was but the count of steps will do so for ever: a record leads the way
        // out in a circle, or deeper than the driver's loops go. (Passes of brute force go on with other primitives.)
        if (!is_brute && is_unchanged(k))
          hits[open[k].ray].kind = HitKind::capped, hits[open[k].ray].steps = results[0][k].z;
        else
          take(open[k].ray, static_cast<std::uint32_t>(k), hits, still_open);
      }
      open = std::move(still_open);
    }
  }

  /// Whether a pixel of the last pass has written the state that it was given: not a result that reads the same. A walk
  /// that stays where it is visits its node again in every pass, so steps tell nothing.
  bool is_unchanged(std::size_t pixel) const {
    if ((results[0][pixel].x & 7u) != kWordUnfinished) return false;
    const auto count = static_cast<std::size_t>(target_count);
    for (std::size_t i = 0; i < count; ++i) {
      PassWords before = state_texels[pixel * count + i], now = results[i][pixel];
      if (i == 0) before.z = now.z = 0u;
      if (before != now) return false;
    }
    return true;
  }
  /// Takes a ray's result from its pixel.
  void take(std::uint32_t ray, std::uint32_t pixel, std::span<Hit> hits, std::vector<Open>& open) const {
    if ((results[0][pixel].x & 7u) == kWordUnfinished) {
      open.push_back({ray, pixel});
    } else {
      hits[ray] = unpack_hit(results[0][pixel], results[1][pixel], results[2][pixel],
                             target_count == kPassTargets ? &results[3][pixel] : nullptr);
    }
  }
};

Probe::Probe(GlContext& context, const GeometryImage& image, Traversal traversal, std::span<const ShaderPatch> patches)
    : impl_(std::make_unique<Impl>(context, traversal, 1, patches)) {
  set_image(image);
}
Probe::Probe(GlContext& context, const GeometryImage& image, BundleSize bundle, std::span<const ShaderPatch> patches)
    : impl_(std::make_unique<Impl>(context, Traversal::tree, bundle.rays, patches)) {
  set_image(image);
}
Probe::Probe(GlContext& context, Traversal traversal, std::span<const ShaderPatch> patches)
    : impl_(std::make_unique<Impl>(context, traversal, 1, patches)) {}
Probe::~Probe() = default;
Probe::Probe(Probe&&) noexcept = default;
Probe& Probe::operator=(Probe&&) noexcept = default;

VisitProbe::VisitProbe(GlContext& context, const GeometryImage& image, std::span<const ShaderPatch> patches)
    : probe_(context, Traversal::tree, patches) {
  probe_.impl_->is_counting = true;
  probe_.set_image(image);
}
void VisitProbe::trace(std::span<const Ray> rays, std::span<Hit> hits) { probe_.trace(rays, hits); }
std::vector<NodeVisits> VisitProbe::visits() const {
  const std::vector<std::uint32_t> counts = probe_.impl_->visits.read();
  std::vector<NodeVisits> visits(counts.size() / 2);
  for (std::size_t i = 0; i < visits.size(); ++i) visits[i] = {counts[2 * i], counts[2 * i + 1]};
  return visits;
}

void Probe::set_image(const GeometryImage& image) { impl_->set_image(image); }

void Probe::trace(std::span<const Ray> rays, std::span<Hit> hits) {
  PLUMBLINE_ASSERT(rays.size() == hits.size());
  impl_->seconds = impl_->resumed_seconds = 0.0;
  impl_->resumed = 0;
  impl_->left_alone = 0;
  const std::size_t batch = impl_->batch_rays();
  for (std::size_t first = 0; first < rays.size(); first += batch) {
    const std::size_t count = std::min(batch, rays.size() - first);
    if (impl_->bundle > 1)
      impl_->trace_bundles(rays.subspan(first, count), hits.subspan(first, count));
    else
      impl_->trace_batch(rays.subspan(first, count), hits.subspan(first, count));
  }
}

void Probe::update(const GeometryImage& image, std::span<const TexelRange> changed) { impl_->update(image, changed); }
std::uint64_t Probe::texels_uploaded() const { return impl_->uploaded; }

double Probe::draw_seconds() const { return impl_->seconds; }
double Probe::resumed_seconds() const { return impl_->resumed_seconds; }
int Probe::resumed_passes() const { return impl_->resumed; }
std::uint64_t Probe::rays_left_alone() const { return impl_->left_alone; }

}  // namespace plumbline
