// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/session.h"

#include "scenes/camera.h"
#include "scenes/generate.h"

namespace plumbline {
namespace {

constexpr std::size_t kSecondarySources = 1 << 14;

/// Spheres of the tree in world space: those of the world's own geometry and of the nodes that stand in it, and of the
/// tree of every instance's part, as far as kMostSpheres reaches.
std::vector<glm::vec4> node_spheres(const Scene& scene, const SceneTree& tree) {
  constexpr std::size_t kMostSpheres = 1 << 16;
  std::vector<glm::vec4> spheres;
  for (const TreeNode& node : tree.world.nodes) spheres.emplace_back(node.center, node.radius);
  if (scene.nodes.empty()) return spheres;
  for (const GroupNode& node : tree.groups.front().nodes) spheres.emplace_back(node.center, node.radius);
  for (const std::uint32_t instance : instances_of(scene)) {
    const TransformD place = to_world(scene, instance);
    const double stretch = largest_stretch(place.linear);
    for (const TreeNode& node : tree.parts[scene.nodes[instance].part].nodes) {
      if (spheres.size() >= kMostSpheres) return spheres;
      spheres.emplace_back(transform_point(place, glm::dvec3(node.center)), stretch * node.radius);
    }
  }
  return spheres;
}

std::string program_key(const GeometryImage& image, Traversal traversal) {
  return variant_name(image.options) + (traversal == Traversal::brute_force ? " brute force" : "");
}

}  // namespace

Stage::Stage(const std::string& spec_, Scene scene_)
    : spec(spec_),
      scene(std::move(scene_)),
      topology(make_topology(scene)),
      arbiter(scene),
      embree(scene),
      tree(build_scene_tree(scene, BakeOptions{}.tree)),
      judge(make_judge(scene, arbiter, topology, tree)),
      image(bake(scene, tree, BakeOptions{})),
      rays(scene, node_spheres(scene, tree)) {}

const GeometryImage& Stage::image_of(TransformOut out) const {
  if (out == image.options.transform_out) return image;
  if (!inverse_image_) {
    BakeOptions options;
    options.transform_out = out;
    inverse_image_ = std::make_unique<const GeometryImage>(bake(scene, tree, options));
  }
  return *inverse_image_;
}

Judge Stage::judge_of(TransformOut out) const {
  Judge j = judge;
  j.drifts = out == TransformOut::inverse;
  return j;
}

Session::Session() = default;
Session::~Session() = default;

Stage& Session::stage(const std::string& spec) {
  if (stage_ && stage_->spec == spec) return *stage_;
  stage_.reset();  // before the next one is built: two big scenes at once would double the peak of memory
  return install(std::make_unique<Stage>(spec, load_scene(spec)));
}

Stage& Session::stage(const std::string& spec, Scene scene) {
  return install(std::make_unique<Stage>(spec, std::move(scene)));
}

Stage& Session::install(std::unique_ptr<Stage> stage) {
  uploaded_.clear();
  stage_ = std::move(stage);
  if (stage_->scene.primitive_count() > 0)
    stage_->rays.set_captured(capture_secondary_rays(*this, *stage_, kSecondarySources));
  return *stage_;
}

Probe& Session::program(const GeometryImage& image, Traversal traversal, int bundle) {
  const std::string key = program_key(image, traversal) + " " + std::to_string(bundle);
  auto& program = programs_[key];
  if (!program) {
    program = bundle > 1 ? std::make_unique<Probe>(context_, image, BundleSize{bundle})
                         : std::make_unique<Probe>(context_, image, traversal);
  } else if (uploaded_[key] != &image) {
    program->set_image(image);
  }
  uploaded_[key] = &image;
  return *program;
}

Probe& Session::probe(const Stage& stage, TransformOut out) { return program(stage.image_of(out), Traversal::tree); }
Probe& Session::bundles(const Stage& stage, int size, TransformOut out) {
  return program(stage.image_of(out), Traversal::tree, size);
}
Probe& Session::brute_force(const Stage& stage) { return program(stage.image, Traversal::brute_force); }

Probe& Session::probe(const GeometryImage& image) {
  uploaded_.erase(program_key(image, Traversal::tree) + " 1");  // a variant's image may stand where an older one stood
  return program(image, Traversal::tree);
}

std::vector<Ray> capture_secondary_rays(Session& session, const Stage& stage, std::size_t count) {
  std::vector<Ray> primary(count), secondary;
  generate_rays(stage.rays, RayFamily::camera, 0, 0, primary);
  std::vector<Hit> hits(count);
  session.probe(stage).trace(primary, hits);
  for (std::size_t i = 0; i < count; ++i) {
    const Hit& hit = hits[i];
    if (hit.kind != HitKind::hit) continue;
    const glm::vec3 d = primary[i].direction;
    secondary.push_back({hit.position, d - 2.0f * glm::dot(d, hit.normal) * hit.normal});
    // A shadow ray ends at the light: t = 1 is the light itself.
    for (const Light& light : stage.scene.lights)
      if (light.position != hit.position) secondary.push_back({hit.position, light.position - hit.position, 1.0f});
  }
  return secondary;
}

}  // namespace plumbline
