// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/picture_engine.h"

#include "scenes/error.h"

namespace plumbline {
namespace {

class ReferenceEngine final : public PictureEngine {
 public:
  ReferenceEngine(const Scene& scene, const ReferenceSettings& settings, const RandomSource* numbers)
      : renderer_(scene, settings), numbers_(numbers) {}

  const std::string& name() const override { return name_; }

  PictureMoments render(std::uint32_t first_frame, std::uint32_t frames) override {
    renderer_.set_frames(first_frame, frames);
    auto picture = renderer_.render({}, numbers_);
    PLUMBLINE_ASSERT(picture.has_value());
    return {picture->width, picture->height, picture->frames, std::move(picture->mean), std::move(picture->variance)};
  }

 private:
  const std::string name_ = "reference";
  ReferenceRenderer renderer_;
  const RandomSource* numbers_;
};

}  // namespace

std::unique_ptr<PictureEngine> reference_engine(const Scene& scene, const ReferenceSettings& settings,
                                                const RandomSource* numbers) {
  return std::make_unique<ReferenceEngine>(scene, settings, numbers);
}

std::unique_ptr<PictureEngine> make_reference_engine(const Scene& scene, const PictureSettings& settings) {
  ReferenceSettings own;
  own.width = settings.width;
  own.height = settings.height;
  own.effects = settings.effects;
  own.seed = settings.seed;
  own.time = settings.time;
  return reference_engine(scene, own);
}

std::vector<glm::dvec3> pixel_means(const std::vector<PictureMoments>& batches) {
  std::vector<glm::dvec3> means(batches.front().mean.size(), glm::dvec3(0.0));
  for (const PictureMoments& batch : batches)
    for (std::size_t i = 0; i < means.size(); ++i) means[i] += batch.mean[i] / static_cast<double>(batches.size());
  return means;
}

}  // namespace plumbline
