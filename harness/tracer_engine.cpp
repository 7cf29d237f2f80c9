// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/tracer_engine.h"

#include <utility>

namespace plumbline {
namespace {

class TracerEngine final : public PictureEngine {
 public:
  TracerEngine(const Scene& scene, const RenderSettings& settings)
      : renderer_(context_, scene, settings),
        name_(std::string("tracer, ") + name_of(settings.random)),
        time_(settings.time) {}

  const std::string& name() const override { return name_; }

  PictureMoments render(std::uint32_t first_frame, std::uint32_t frames) override {
    renderer_.restart(time_);
    renderer_.add_frames(first_frame, frames);
    RenderedPicture picture = renderer_.moments();
    return {picture.width, picture.height, picture.frames, std::move(picture.mean), std::move(picture.variance)};
  }

 private:
  GlContext context_;
  Renderer renderer_;
  std::string name_;
  double time_;
};

class EditedEngine final : public PictureEngine {
 public:
  EditedEngine(const MakePictureEngine& make, Scene scene, const PictureSettings& settings)
      : scene_(std::move(scene)), engine_(make(scene_, settings)) {}
  const std::string& name() const override { return engine_->name(); }
  PictureMoments render(std::uint32_t first_frame, std::uint32_t frames) override {
    return engine_->render(first_frame, frames);
  }

 private:
  const Scene scene_;
  const std::unique_ptr<PictureEngine> engine_;
};

}  // namespace

MakePictureEngine edited_engines(MakePictureEngine make, std::function<void(Scene&)> edit) {
  return [make = std::move(make), edit = std::move(edit)](const Scene& scene, const PictureSettings& settings) {
    Scene edited = scene;
    edit(edited);
    return std::make_unique<EditedEngine>(make, std::move(edited), settings);
  };
}

MakePictureEngine tracer_engines(RenderSettings own) {
  return [own = std::move(own)](const Scene& scene, const PictureSettings& settings) {
    RenderSettings asked = own;
    asked.width = settings.width, asked.height = settings.height;
    asked.effects = settings.effects;
    asked.seed = settings.seed;
    asked.time = settings.time;
    return std::make_unique<TracerEngine>(scene, asked);
  };
}

std::unique_ptr<PictureEngine> make_tracer_engine(const Scene& scene, const PictureSettings& settings) {
  return tracer_engines()(scene, settings);
}

}  // namespace plumbline
