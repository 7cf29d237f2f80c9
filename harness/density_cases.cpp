// SPDX-License-Identifier: GPL-3.0-or-later
// The cases `drt.densities.*`, and the reference's perturbations.
#include "harness/compare_pictures.h"
#include "harness/densities.h"
#include "harness/independent.h"
#include "reference/perturbation.h"
#include "reference/random_source.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// First dimension of the primary ray's numbers for an effect (SEMANTICS 7.3), and how many it takes.
struct Numbers {
  std::uint32_t first = 0;
  std::size_t count = 3;
};
Numbers numbers_of(const std::string& effect) {
  if (effect == "aa") return {0, 2};
  if (effect == "dof") return {2, 3};
  if (effect == "glossy") return {5, 3};
  return {8, 3};
}

Body body_of(const std::string& effect, Effects::Model model) {
  if (effect == "motion_blur") return Body::interval;
  if (effect == "aa") return Body::square;
  if (model == Effects::Model::paper) return Body::cube;
  return effect == "dof" ? Body::disc : Body::ball;
}

glm::dvec3 place_of(Body body, const glm::dvec3& u) {
  switch (body) {
    case Body::cube:
      return in_cube(u);
    case Body::disc:
      return on_disc(u);
    case Body::ball:
      return in_ball(u);
    default:
      return u;
  }
}

}  // namespace

std::vector<Case> density_cases(const PerturbationSource& source) {
  std::vector<Case> cases;
  for (const std::string& effect : effect_names())
    for (const Effects::Model model : {Effects::Model::paper, Effects::Model::physical}) {
      const bool one_model = effect == "aa" || effect == "motion_blur";
      if (one_model && model == Effects::Model::physical) continue;
      Case c;
      c.name = "drt.densities." + source.name + "." + effect;
      if (!one_model) c.name += model == Effects::Model::paper ? ".paper" : ".physical";
      c.feature = effect;
      c.paper = "7";
      c.proves = "Perturbations are uniform in the " + std::string(name_of(body_of(effect, model))) +
                 ", independent between dimensions, neighbouring pixels and frames.";
      c.run = [source, effect, model](CaseContext& context, const Case& self, CaseRecord& record) {
        const bool one_pixel = effect == "motion_blur";
        const PerturbationGrid grid = source.take(context, effect, model, case_seed(context.seed, self.name),
                                                  one_pixel ? 1 : 64, one_pixel ? 1 : 48, one_pixel ? 1u << 16 : 128);
        const Body body = body_of(effect, model);
        record_density(test_density(body, grid, source.rounding, kCaseLevel), body, kCaseLevel, context.out, self.name,
                       record);
      };
      cases.push_back(std::move(c));
    }
  return cases;
}

PerturbationSource reference_perturbations() {
  PerturbationSource source;
  source.name = "reference";
  source.rounding = 0x1p-50;  // in double
  source.take = [](CaseContext&, const std::string& effect, Effects::Model model, std::uint64_t seed, int width,
                   int height, std::uint32_t frames) {
    const PhiloxSource numbers(seed);
    const Body body = body_of(effect, model);
    PerturbationGrid grid{width, height, frames, {}};
    for (std::uint32_t f = 0; f < frames; ++f)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          if (body == Body::interval) {
            grid.values.emplace_back(numbers.time(f), 0.0, 0.0);
            continue;
          }
          const Numbers which = numbers_of(effect);
          std::array<double, 3> u{};
          numbers.fill({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), f, 1, which.first},
                       std::span(u).first(which.count));
          grid.values.push_back(place_of(body, {u[0], u[1], u[2]}));
        }
    return grid;
  };
  return source;
}

}  // namespace plumbline
