// SPDX-License-Identifier: MIT
#include "tracer/walk_trace.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <utility>

#include "scenes/error.h"
#include "tracer/image_view.h"
#include "tracer/pass.h"
#include "tracer/shader_words.h"

namespace plumbline {
namespace {

constexpr int kTargets = 2 * kPassTargets;  // of the production, and of the event
constexpr std::size_t kEventPixels = kCapturePixels - 1;
// A walk stops between two nodes; room for a cluster and changes of space spares most passes a repetition.
static_assert(kEventsPerPass + 32 < kCapturePixels);
constexpr int kNoEnd = std::numeric_limits<int>::max();

/// What a pixel kept of an event.
using Event = std::array<PassWords, kPassTargets>;

float value(std::uint32_t word) { return std::bit_cast<float>(word); }
glm::vec3 values3(const PassWords& words) { return {value(words.x), value(words.y), value(words.z)}; }

NodeTest node_test(const WalkStep& step, bool is_hit, bool is_end, bool boxes) {
  if (is_end) return NodeTest::end;
  if (is_hit) return NodeTest::hit;
  if (boxes) {
    if (std::isnan(step.enter) || std::isnan(step.leave)) return NodeTest::not_a_number;
    if (step.enter > step.leave) return NodeTest::missed;
    return step.leave < 0.0f ? NodeTest::behind : step.enter > step.bound ? NodeTest::beyond : NodeTest::missed;
  }
  if (std::isnan(step.distance2) || std::isnan(step.radius2)) return NodeTest::not_a_number;
  if (step.line_distance2 > step.radius2) return NodeTest::missed;
  return step.foot < 0.0f ? NodeTest::behind : step.foot > step.bound ? NodeTest::beyond : NodeTest::missed;
}

PrimitiveTest primitive_test(const TestedPrimitive& tested, std::uint32_t flags) {
  if ((flags & kCaptureAccepted) != 0) return PrimitiveTest::new_nearest;
  if ((flags & kCapturePending) != 0) return PrimitiveTest::edge_on;
  if ((flags & kCaptureHit) == 0) return PrimitiveTest::outside;
  if (std::isnan(tested.t_world)) return PrimitiveTest::not_a_number;
  if (!(tested.t > tested.t_low)) return PrimitiveTest::behind;
  return tested.t_world == tested.nearest_before ? PrimitiveTest::tie_lost : PrimitiveTest::farther;
}

/// Makes steps of events.
class Decoder {
 public:
  Decoder(const GeometryImage& image, Walk& walk) : image_(image), walk_(walk) {}

  void take(const Event& event) {
    switch (event[0].x & 7u) {
      case kCaptureNode:
        take_node(event);
        break;
      case kCapturePrimitive:
      case kCaptureEdgeOn:
        take_primitive(event);
        break;
      default:
        take_change(event);
        break;
    }
  }

 private:
  void take_node(const Event& e) {
    WalkStep step;
    step.number = e[0].y;
    step.again = !walk_.steps.empty() && walk_.steps.back().number == step.number;
    step.space = e[3].x;
    place(e, step);
    const bool boxes = has_boxes(image_), is_end = is_compact(image_) && e[2].w == kEndWord;
    step.bound = value(e[2].x);
    step.link = {value(e[2].y), value(e[2].z)};
    step.word = value(e[2].w);
    if (is_end) {
      // Nothing is tested.
    } else if (boxes) {
      step.enter = value(e[1].x), step.leave = value(e[1].y);
    } else {
      step.distance2 = value(e[1].x), step.foot = value(e[1].y), step.line_distance2 = value(e[1].z);
      step.radius2 = is_compact(image_) ? std::fabs(step.word) : step.word;
    }
    step.test = node_test(step, (e[0].x & kCaptureHit) != 0, is_end, boxes);
    if (!walk_.steps.empty()) walk_.steps.back().next = step.cell;
    walk_.steps.push_back(std::move(step));
  }

  /// Where the node stands: in the image, and in the region that the walk is in.
  void place(const Event& e, WalkStep& step) const {
    const auto width = static_cast<std::uint32_t>(image_.width);
    if (is_compact(image_)) {
      step.cell = e[0].z;
      step.x = static_cast<int>(step.cell % width), step.y = static_cast<int>(step.cell / width);
    } else {
      // The texel that the texture unit reads: coordinates beyond the image end at its border.
      const auto texel = [](std::uint32_t word, int size) {
        return static_cast<int>(
            std::clamp(std::floor(value(word) * static_cast<float>(size)), 0.0f, static_cast<float>(size - 1)));
      };
      step.x = texel(e[0].z, image_.width), step.y = texel(e[0].w, image_.height);
      step.cell = static_cast<std::uint32_t>(step.y / 2) * width + static_cast<std::uint32_t>(step.x);
    }
    std::uint64_t start = 0, size = image_.copy_size;
    if (step.space != kNone) {
      if (step.space >= image_.transform_count) return;
      const auto first = whole_number(record_texel(image_, step.space, 4).w);
      const auto count = whole_number(record_texel(image_, step.space, 5).w);
      if (!first || !count) return;
      start = *first, size = *count;
    }
    if (size == 0 || step.cell < start || step.cell >= start + size * image_.copy_count) return;
    step.copy = static_cast<std::uint32_t>((step.cell - start) / size);
    step.node = static_cast<std::uint32_t>((step.cell - start) % size) / node_units(image_);
  }

  void take_primitive(const Event& e) {
    TestedPrimitive tested;
    const float label = value(e[0].w);
    tested.primitive = primitive_of_label(label).value_or(kNone);
    tested.k = e[0].z;
    tested.is_sphere = (e[0].x & kCaptureSphere) != 0;
    tested.is_last = label < 0.0f;
    tested.resolved = (e[0].x & 7u) == kCaptureEdgeOn;
    tested.t = value(e[1].x);
    tested.t_world = tested.t * ray_.t_scale + ray_.t_shift;
    tested.weights = {value(e[1].y), value(e[1].z)};
    tested.t_low = value(e[1].w);
    tested.numbers = glm::vec4(values3(e[2]), value(e[2].w));
    tested.nearest_before = value(e[3].y), tested.nearest_after = value(e[3].z);
    tested.outcome = primitive_test(tested, e[0].x);
    // Before the first step nothing is tested; a broken driver may say so all the same.
    if (!walk_.steps.empty()) walk_.steps.back().primitives.push_back(tested);
  }

  void take_change(const Event& e) {
    SpaceChange change;
    const bool misses = (e[0].x & kCaptureMisses) != 0;
    change.node = e[0].z;
    change.space = e[0].w;
    change.copy = e[3].z;
    change.ray = {values3(e[1]), values3(e[2]), value(e[1].w), value(e[2].w), value(e[3].y), value(e[3].x)};
    ray_ = change.ray;
    switch (e[0].x & 7u) {
      case kCaptureEnter:
        change.kind = misses ? SpaceChange::Kind::missed : SpaceChange::Kind::entered;
        break;
      case kCaptureLeave:
        change.kind = SpaceChange::Kind::left;
        break;
      default:
        change.kind = walk_.steps.empty() ? SpaceChange::Kind::started : SpaceChange::Kind::resumed;
        break;
    }
    if (walk_.steps.empty()) {
      walk_.start = change;
    } else {
      walk_.steps.back().changes.push_back(change);
    }
  }

  const GeometryImage& image_;
  Walk& walk_;
  SpaceRay ray_;
};

}  // namespace

struct WalkRecorder::Impl {
  using Clock = std::chrono::steady_clock;

  GlContext* context;
  const GeometryImage* image = nullptr;
  std::vector<ShaderPatch> patches;
  PassConstants constants;
  std::vector<std::pair<ProgramVariant, GlProgram>> programs;
  GlTexture geometry, rays, state;
  std::array<GlTexture, kTargets> targets;
  GlFramebuffer framebuffer;
  std::array<std::vector<PassWords>, kTargets> results;
  double seconds = 0.0;  // of the walk at hand

  Impl(GlContext& c, std::span<const ShaderPatch> p) : context(&c), patches(p.begin(), p.end()) {
    rays = GlTexture::linear(c, std::array<glm::vec4, 2>{});
    state = GlTexture(c, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kTargets, 1);
    for (GlTexture& target : targets)
      target = GlTexture(c, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, kCaptureWidth, kCaptureHeight);
    framebuffer = GlFramebuffer(c, targets.data(), kTargets);
    for (auto& result : results) result.resize(kCapturePixels);
  }

  void set_image(const GeometryImage& i) {
    require_fitting_image(*context, i);
    image = &i;
    program(false);
    constants = pass_constants(i);
    geometry = {};  // the old image goes first: two large ones need not fit
    geometry = upload_image(*context, i);
  }

  const GlProgram& program(bool thorough) {
    ProgramVariant variant = program_variant(*image, false, thorough);
    variant.capture = true;
    for (const auto& [known, compiled] : programs) {
      if (known == variant) return compiled;
    }
    GlProgram compiled(*context,
                       link_program(*context, probe_vertex_shader(), probe_fragment_shader(variant, patches)));
    return programs.emplace_back(variant, std::move(compiled)).second;
  }

  int production_targets() const { return image->transform_count > 0 ? kPassTargets : kPassTargets - 1; }

  /// How a pass begins, and what it keeps.
  struct Pass {
    bool thorough = false;
    int mode = 0;  // 0: a new walk; 1: as production goes on; kCaptureGoesOn
    int first_event = 0, enough_events = kEventsPerPass;
    int width = kCaptureWidth, height = kCaptureHeight;
  };

  void draw(const Pass& pass) {
    const GlProgram& code = program(pass.thorough);
    const GlFunctions& gl = context->use();
    geometry.bind(kGeometryUnit);
    rays.bind(kRayUnit);
    state.bind(kStateUnit);
    code.use();
    PassConstants own = constants;
    own.transforms.w = pass.enough_events;
    set_pass(code, own,
             {constants.scale_exponent, pass.mode, static_cast<int>(image->primitive_count), pass.first_event});
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    gl.Disable(GL_DITHER);
    const auto start = Clock::now();
    code.draw(pass.width, pass.height);
    for (int i = 0; i < kTargets; ++i) {
      if (i == kPassTargets - 1 && i == production_targets()) continue;  // nothing is written to it
      gl.ReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
      gl.ReadPixels(0, 0, pass.width, pass.height, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                    results[static_cast<std::size_t>(i)].data());
    }
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    context->check("capturing a walk");
  }

  std::uint32_t count_at(std::size_t pixel) const { return results[kTargets - 1][pixel].w; }

  /// Whether all pixels came to the same end.
  bool pixels_agree(const Pass& pass) const {
    const std::size_t pixels = static_cast<std::size_t>(pass.width) * static_cast<std::size_t>(pass.height);
    for (std::size_t pixel = 1; pixel < pixels; ++pixel) {
      if (count_at(pixel) != count_at(0)) return false;
      for (std::size_t i = 0; i < static_cast<std::size_t>(production_targets()); ++i)
        if (results[i][pixel] != results[i][0]) return false;
    }
    return true;
  }

  /// State and ray by which the next pass goes on, from a pixel that holds no event.
  std::array<PassWords, kTargets> state_of_pass(const Pass& pass) const {
    const std::size_t pixel = static_cast<std::size_t>(pass.width) * static_cast<std::size_t>(pass.height) -
                              1;  // the last one of a full pass
    std::array<PassWords, kTargets> words{};
    const auto count = static_cast<std::size_t>(production_targets());
    for (std::size_t i = 0; i < count; ++i) words[i] = results[i][pixel];
    for (std::size_t i = 0; i + kPassTargets < kTargets && i + count < kTargets; ++i)
      words[count + i] = results[kPassTargets + i][pixel];
    return words;
  }

  Walk record(const Ray& ray, std::size_t most_events, int events_per_pass) {
    Walk walk;
    walk.ray = ray;
    Decoder decoder(*image, walk);
    const std::array<glm::vec4, 2> texels{glm::vec4(ray.origin, ray.t_max), glm::vec4(ray.direction, 0.0f)};
    rays.update(texels);
    seconds = 0.0;
    Pass pass;
    pass.enough_events = events_per_pass;
    std::size_t events = 0;
    std::array<PassWords, kTargets> last_state{};
    for (;;) {
      pass.first_event = 0;
      draw(pass);
      ++walk.passes;
      const std::uint32_t count = count_at(0) & 0x3fffffffu;
      const bool is_full = count_at(0) >> 31 != 0;
      walk.driver_agrees = walk.driver_agrees && pixels_agree(pass);
      const auto next = state_of_pass(pass);
      const PassWords ends[kPassTargets] = {results[0][0], results[1][0], results[2][0], results[3][0]};
      std::size_t taken = 0;
      // A cluster may have more primitives than the pass has pixels: again, for those that came later.
      while (pass.enough_events != kNoEnd && taken < count && events < most_events) {
        if (taken > 0) {
          pass.first_event = static_cast<int>(taken);
          draw(pass);
          ++walk.passes;
          walk.driver_agrees = walk.driver_agrees && pixels_agree(pass);
        }
        const std::size_t here = std::min(std::min(kEventPixels, count - taken), most_events - events);
        for (std::size_t i = 0; i < here; ++i)
          decoder.take({results[4][i], results[5][i], results[6][i], results[7][i]});
        taken += here;
        events += here;
      }
      walk.skipped += count - taken;
      if ((ends[0].x & 7u) != kWordUnfinished) {
        walk.hit = unpack_hit(ends[0], ends[1], ends[2], production_targets() == kPassTargets ? &ends[3] : nullptr);
        break;
      }
      if (!is_full && pass.mode == 1 && next == last_state)
        throw EnvironmentError("a captured walk does not advance from pass to pass; the OpenGL driver (" +
                               context->renderer() + ") loses its state");
      if (!is_full && !pass.thorough && program_variant(*image, false, false).out_inverse) {
        // As in production, a ray that drifts starts anew in the thorough program.
        pass = Pass{};
        pass.enough_events = events_per_pass;
        walk.steps.clear();
        walk.skipped = 0;
        events = 0;
      }
      pass.mode = is_full ? kCaptureGoesOn : 1;
      pass.thorough = pass.thorough || !is_full;
      if (events >= most_events) {  // the rest is only walked, by few pixels
        pass.enough_events = kNoEnd;
        pass.width = 8, pass.height = 1;
      }
      last_state = next;
      const GlFunctions& gl = context->use();
      state.bind(kStateUnit);
      gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kTargets, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, next.data());
    }
    walk.seconds = seconds;
    if (!walk.steps.empty() && walk.skipped == 0) walk.steps.back().ended = walk.hit.kind != HitKind::capped;
    return walk;
  }
};

WalkRecorder::WalkRecorder(GlContext& context, const GeometryImage& image, std::span<const ShaderPatch> patches)
    : impl_(std::make_unique<Impl>(context, patches)) {
  set_image(image);
}
WalkRecorder::~WalkRecorder() = default;
WalkRecorder::WalkRecorder(WalkRecorder&&) noexcept = default;
WalkRecorder& WalkRecorder::operator=(WalkRecorder&&) noexcept = default;

void WalkRecorder::set_image(const GeometryImage& image) { impl_->set_image(image); }

Walk WalkRecorder::record(const Ray& ray, std::size_t most_events, int events_per_pass) {
  return impl_->record(ray, most_events, events_per_pass);
}

Walk capture_walk(GlContext& context, const GeometryImage& image, const Ray& ray,
                  std::span<const ShaderPatch> patches) {
  return WalkRecorder(context, image, patches).record(ray);
}

}  // namespace plumbline
