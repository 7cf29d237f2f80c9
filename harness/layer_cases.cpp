// SPDX-License-Identifier: GPL-3.0-or-later
// The cases that take the tracer apart: `layers.*` (the tree against a loop over all primitives), `variants.*` (options
// that must not change an answer) and `bake.*` (the image on disk).
#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>

#include "harness/catalogue.h"
#include "harness/explained_cases.h"
#include "harness/hit_cases.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// Primitives, counted in every instance, that the brute-force layer takes on: it asks each for every ray.
constexpr std::uint64_t kMostBruteForce = 2'000'000;

std::size_t rays_per_family(std::uint64_t tests, const Stage& stage) {
  const std::uint64_t primitives = std::max<std::uint64_t>(1, placed_count(stage.scene));
  return std::clamp<std::uint64_t>(tests / primitives / ray_families().size(), 16, 4096);
}

}  // namespace

Case brute_force_case(const ListedScene& scene, std::uint64_t tests) {
  Case c = scene_case(
      (scene.has_nodes ? "transforms.brute_force." : "layers.brute_force.") + scene.name,
      scene.has_nodes ? "transforms" : "hits", scene, "4",
      "The tree loses nothing: the production walk answers bit for bit what a loop over all primitives answers with "
      "the same primitive functions.");
  c.run = [tests](CaseContext& context, const Case& self, CaseRecord& record) {
    Stage& stage = context.session.stage(self.spec);
    if (placed_count(stage.scene) > kMostBruteForce) {
      record.status = CaseStatus::skipped;
      record.message = std::to_string(placed_count(stage.scene)) + " primitives are too many for a loop over all";
      return;
    }
    const std::vector<Ray> rays =
        mixed_rays(stage.rays, case_seed(context.seed, self.name), rays_per_family(tests, stage));
    std::vector<Hit> tree(rays.size()), brute(rays.size());
    context.session.probe(stage).trace(rays, tree);
    context.session.brute_force(stage).trace(rays, brute);
    record_differences(rays, tree, brute, "brute force", self.spec, record);
    explain_failing(context, examined_of(stage), record, 0);
    count_layers(record);
  };
  return c;
}

Case variants_case(const ListedScene& scene, std::uint64_t per_family) {
  Case c = scene_case((scene.has_nodes ? "transforms.variants." : "variants.all.") + scene.name,
                      scene.has_nodes ? "transforms" : "bake", scene, "9",
                      "No variant of bake or shader changes an answer in any bit.");
  c.variant = "bake=every variant";
  c.run = [per_family, placed = scene.has_nodes](CaseContext& context, const Case& self, CaseRecord& record) {
    Stage& stage = context.session.stage(self.spec);
    const std::vector<Ray> rays = mixed_rays(stage.rays, case_seed(context.seed, self.name), per_family);
    std::vector<Hit> standard(rays.size()), hits(rays.size());
    context.session.probe(stage).trace(rays, standard);
    const std::vector<Variant> variants = all_variants(placed);
    VariantTrees trees(stage.scene, stage.tree);
    for (std::size_t i = 0; i < variants.size(); ++i) {
      const GeometryImage image = bake(stage.scene, trees.of(variants[i].options), variants[i].options);
      Probe& probe = context.session.probe(image);
      probe.trace(rays, hits);
      const std::size_t before = record.worst.size();
      record_differences(rays, hits, standard, "the default variant, as " + variants[i].name, self.spec, record);
      explain_failing(context, {&stage, &image, &image, {}, "variant " + variants[i].name}, record, before);
      context.progress(static_cast<double>(i + 1) / static_cast<double>(variants.size()));
    }
    count_layers(record);
    record.figures.push_back({"variants", "", static_cast<double>(variants.size())});
  };
  return c;
}

Case bake_file_case(const ListedScene& scene) {
  Case c = scene_case("bake.file." + scene.name, "bake", scene, "3",
                      "A geometry image written to OpenEXR and read back is the same, bit for bit.");
  c.run = [](CaseContext& context, const Case& self, CaseRecord& record) {
    Stage& stage = context.session.stage(self.spec);
    const std::filesystem::path file = context.out / ("bake_" + self.scene + ".exr");
    write_geometry_image(stage.image, file);
    const GeometryImage back = read_geometry_image(file);
    std::error_code ignored;
    record.figures.push_back({"file", "bytes", static_cast<double>(std::filesystem::file_size(file, ignored))});
    std::filesystem::remove(file, ignored);
    record.figures.push_back({"image", "texels", static_cast<double>(back.texels.size())});
    const bool same =
        back.width == stage.image.width && back.height == stage.image.height &&
        back.texels.size() == stage.image.texels.size() &&
        std::memcmp(back.texels.data(), stage.image.texels.data(), back.texels.size() * sizeof(glm::vec4)) == 0;
    if (!same) {
      record.status = CaseStatus::failed;
      record.message = "the image read back differs from the one written";
    }
  };
  return c;
}

}  // namespace plumbline
