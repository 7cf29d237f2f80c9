// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/tree_file.h"

#include "harness/variants.h"
#include "scenes/error.h"
#include "tracer/verify.h"

namespace plumbline {

GeometryImage read_tree_of(const Scene& scene, const std::string& spec, const std::filesystem::path& file) {
  GeometryImage image = read_geometry_image(file);
  const auto refuse = [&](const std::string& what) {
    throw InputError(file.string() + ": no tree of " + spec + ": " + what + "; it was baked from a scene named '" +
                     image.scene_name + "'");
  };
  if (image.transform_count != scene.nodes.size())
    refuse("it holds " + std::to_string(image.transform_count) + " transforms, the scene " +
           std::to_string(scene.nodes.size()));
  const Certificate certificate = certify(image, &scene);
  const auto count = [&](const char* rule) {
    const auto found = certificate.counts.find(rule);
    return found == certificate.counts.end() ? std::uint64_t{0} : found->second;
  };
  if (const std::uint64_t other = count("primitive_bits"); 2 * other > image.primitive_count)
    refuse(std::to_string(other) + " of its " + std::to_string(image.primitive_count) +
           " primitives are not the scene's");
  if (const std::uint64_t missing = count("primitive_missing"); 2 * missing > scene.primitive_count())
    refuse(std::to_string(missing) + " of the scene's " + std::to_string(scene.primitive_count()) +
           " primitives are not in it");
  return image;
}

BakeOptions variant_options(const std::string& name) {
  BakeOptions options;
  if (name == "default") return options;
  if (name == "inverse") {
    options.transform_out = TransformOut::inverse;
    return options;
  }
  std::string known = "default, inverse";
  for (const Variant& variant : all_variants(true)) {
    if (variant.name == name) return variant.options;
    known += ", " + variant.name;
  }
  throw InputError("--against " + name + " is no variant, and neither TREE.exr nor WALK.json; variants are " + known);
}

}  // namespace plumbline
