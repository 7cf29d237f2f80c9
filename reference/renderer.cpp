// SPDX-License-Identifier: GPL-3.0-or-later
// Tiles on all cores, frame after frame where the scene moves, and the sums of each pixel.
#include "reference/renderer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "scenes/error.h"

namespace plumbline {

namespace {

constexpr int kTile = 16;            ///< side of a tile, pixels

/// Mean and sum of squared deviations of samples that come one by one (Welford 1962): nothing cancels, and in double
/// the mean of 10^9 samples is within 10^-7 of an ulp of a float.
struct Accumulator {
  glm::dvec3 mean{0.0}, squares{0.0};
  std::uint32_t count = 0;

  void add(const glm::dvec3& value) {
    ++count;
    const glm::dvec3 before = value - mean;
    mean += before / static_cast<double>(count);
    squares += before * (value - mean);
  }
};

ReferenceSettings completed(const Scene& scene, ReferenceSettings settings) {
  complete_picture_request(scene.camera, settings.width, settings.height, settings.first_frame, settings.frames,
                           settings.time);
  if (!settings.effects) settings.effects = scene.effects;
  return settings;
}

}  // namespace

struct ReferenceRenderer::Impl {
  Scene scene;
  ReferenceSettings settings;
  bool lit_by_default = false;
  PhiloxSource own_numbers;
  EmbreeScene hits;
  PreparedScene prepared;
  double time_now;

  Impl(const Scene& given, const ReferenceSettings& asked)
      : scene(at_time(given, asked.time)),
        settings(completed(scene, asked)),
        own_numbers(settings.seed),
        hits(scene),
        time_now(settings.time) {
    scene.camera.width = settings.width;
    scene.camera.height = settings.height;
    if (scene.lights.empty()) {
      scene.lights.push_back(default_light(scene.camera));
      lit_by_default = true;
    }
    prepared.scene = &scene;
    prepared.hits = &hits;
    prepared.views = instance_views(scene);
    prepared.camera = camera_frame(scene.camera);
    prepared.aperture = static_cast<double>(scene.camera.aperture);
    prepared.focus = focus_distance(scene.camera);
    prepared.effects = *settings.effects;
    if (prepared.effects.depth_of_field) require_lens_before_focus(scene.camera);
  }

  static Scene at_time(const Scene& given, double time) {
    Scene scene = given;
    if (!scene.animation.empty()) set_time(scene, time);
    return scene;
  }

  bool moves() const {
    const Camera& camera = scene.camera;
    return prepared.effects.motion_blur && camera.shutter_open != camera.shutter_close && !scene.animation.empty();
  }
  double time_of(std::uint32_t frame, const RandomSource& numbers) const {
    if (!moves()) return settings.time;
    const auto open = static_cast<double>(scene.camera.shutter_open),
               close = static_cast<double>(scene.camera.shutter_close);
    return settings.time + open + numbers.time(frame) * (close - open);
  }
  void go_to(double time) {
    if (time == time_now) return;
    set_time(scene, time);
    hits.move_nodes(scene);
    prepared.views = instance_views(scene);
    time_now = time;
  }

  /// Calls `each(tile's first column, first row)` for all tiles on all cores. False where `done` ended it, which is
  /// told of each tile's end.
  template <class Each, class Done>
  bool over_tiles(Each each, Done done) const {
    const int columns = (settings.width + kTile - 1) / kTile, rows = (settings.height + kTile - 1) / kTile;
    std::atomic<bool> ended = false;
    tbb::parallel_for(0, columns * rows, [&](int tile) {
      if (ended) return;
      const int left = (tile % columns) * kTile, top = (tile / columns) * kTile;
      for (int y = top; y < std::min(top + kTile, settings.height); ++y)
        for (int x = left; x < std::min(left + kTile, settings.width); ++x) each(x, y);
      if (!done(1.0 / (columns * rows))) ended = true;
    });
    return !ended;
  }

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(settings.width) + static_cast<std::size_t>(x);
  }

  void trace_sharp(int x, int y, RenderedPicture& picture) const {
    const CameraFrame& camera = prepared.camera;
    const glm::dvec3 through = camera.forward + camera.pixel * (x - camera.centre_x) * camera.right +
                               camera.pixel * (camera.centre_y - y) * camera.up;
    const ReferenceHit hit = first_hit(prepared, {glm::vec3(camera.from), glm::vec3(glm::normalize(through))});
    if (hit.kind != HitKind::hit) return;
    const std::size_t i = at(x, y);
    picture.depth[i] = hit.t;
    picture.normal[i] = hit.normal;
    picture.primitive[i] = hit.primitive;
    picture.instance[i] = hit.instance;
  }
};

ReferenceRenderer::ReferenceRenderer(const Scene& scene, const ReferenceSettings& settings)
    : impl_(std::make_unique<Impl>(scene, settings)) {}
ReferenceRenderer::~ReferenceRenderer() = default;

bool ReferenceRenderer::lit_by_default() const { return impl_->lit_by_default; }
const ReferenceSettings& ReferenceRenderer::settings() const { return impl_->settings; }
void ReferenceRenderer::set_frames(std::uint32_t first, std::uint32_t count) {
  if (count < 1) throw InputError("a picture needs at least one frame");
  impl_->settings.first_frame = first;
  impl_->settings.frames = count;
}

std::optional<RenderedPicture> ReferenceRenderer::render(const ReferenceProgress& progress,
                                                          const RandomSource* numbers) {
  Impl& impl = *impl_;
  const RandomSource& source = numbers != nullptr ? *numbers : impl.own_numbers;
  const ReferenceSettings& settings = impl.settings;
  const std::size_t count = static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height);
  RenderedPicture picture;
  picture.width = settings.width, picture.height = settings.height;
  picture.frames = settings.frames;
  picture.depth.assign(count, std::numeric_limits<double>::infinity());
  picture.normal.assign(count, glm::dvec3(0.0));
  picture.primitive.assign(count, kNone);
  picture.instance.assign(count, kNone);
  impl.go_to(settings.time);
  impl.over_tiles([&](int x, int y) { impl.trace_sharp(x, y, picture); }, [](double) { return true; });

  // Where nothing moves a tile takes all its frames at once; else all of the scene must stand at one time.
  const std::uint32_t at_once = impl.moves() ? 1 : settings.frames;
  std::vector<Accumulator> sums(count);
  std::mutex one_at_a_time;
  double share_done = 0.0;
  for (std::uint32_t first = 0; first < settings.frames; first += at_once) {
    impl.go_to(impl.time_of(settings.first_frame + first, source));
    const auto take_samples = [&](int x, int y) {
      Accumulator& sum = sums[impl.at(x, y)];
      for (std::uint32_t i = 0; i < at_once; ++i)
        sum.add(sample_color(impl.prepared, source, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                             settings.first_frame + first + i));
    };
    const auto tell = [&](double share) {
      const std::lock_guard lock(one_at_a_time);
      share_done += share * at_once / settings.frames;
      return !progress || progress(std::min(share_done, 1.0));
    };
    if (!impl.over_tiles(take_samples, tell)) return std::nullopt;
  }
  for (const Accumulator& sum : sums) picture.mean.push_back(sum.mean);
  if (settings.frames > 1)
    for (const Accumulator& sum : sums) picture.variance.push_back(sum.squares / (settings.frames - 1.0));
  return picture;
}

glm::dvec3 ReferenceRenderer::sample(std::uint32_t x, std::uint32_t y, std::uint32_t frame, SampleRecord* record,
                                     const RandomSource* numbers) {
  const RandomSource& source = numbers != nullptr ? *numbers : impl_->own_numbers;
  impl_->go_to(impl_->time_of(frame, source));
  return sample_color(impl_->prepared, source, x, y, frame, record);
}

}  // namespace plumbline
