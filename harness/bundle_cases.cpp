// SPDX-License-Identifier: GPL-3.0-or-later
// `bundles.SIZE.SCENE`: rays that walk the tree together answer as each does alone.
#include "harness/bundle_cases.h"

#include "harness/catalogue.h"
#include "harness/hit_cases.h"

namespace plumbline {

std::vector<Ray> bundled_rays(const RaySource& source, std::uint64_t seed, std::size_t each) {
  std::vector<Ray> rays;
  for (const RayFamily family : {RayFamily::camera, RayFamily::chords}) {
    std::vector<Ray> alike(each);
    generate_rays(source, family, seed, 0, alike);
    rays.insert(rays.end(), alike.begin(), alike.end());
  }
  const std::vector<Ray> mixed = mixed_rays(source, seed, each);
  for (std::size_t i = 0; i < each; ++i)
    for (std::size_t f = 0; f < ray_families().size(); ++f) rays.push_back(mixed[f * each + i]);
  return rays;
}

std::vector<Case> bundle_cases(const ListedScene& scene, std::uint64_t per_family) {
  std::vector<Case> cases;
  for (const int size : {2, 3, 4}) {
    Case c = scene_case(
        "bundles." + std::to_string(size) + "." + scene.name, "bundles", scene, "5",
        "Rays that walk the tree together, alike or not, answer bit for bit as each does alone (parallel traversal).");
    c.variant = "bundle=" + std::to_string(size);
    const std::size_t outs = scene.has_nodes ? 2 : 1;
    c.rays = outs * per_family * (ray_families().size() + 2);
    c.run = [per_family, size, outs](CaseContext& context, const Case& self, CaseRecord& record) {
      Stage& stage = context.session.stage(self.spec);
      if (is_skipped(stage, record)) return;
      const std::vector<Ray> rays = bundled_rays(stage.rays, case_seed(context.seed, self.name), per_family);
      std::vector<Hit> alone(rays.size()), together(rays.size());
      std::uint64_t left_alone = 0;
      for (const TransformOut out : {TransformOut::restore, TransformOut::inverse}) {
        if (out == TransformOut::inverse && outs < 2) continue;
        context.session.probe(stage, out).trace(rays, alone);
        Probe& bundles = context.session.bundles(stage, size, out);
        bundles.trace(rays, together);
        left_alone += bundles.rays_left_alone();
        record_differences(rays, together, alone, std::string("the ray alone, ") + name_of(out), self.spec, record);
        context.progress(out == TransformOut::inverse ? 1.0 : 1.0 / static_cast<double>(outs));
      }
      record.figures.push_back(
          {"left to walk alone", "share", static_cast<double>(left_alone) / static_cast<double>(record.rays)});
    };
    cases.push_back(std::move(c));
  }
  return cases;
}

}  // namespace plumbline
