// SPDX-License-Identifier: GPL-3.0-or-later
// Rays of all families through probes whose shader is a mutant. Each answer is judged by bounds and the arbiter, as in
// any case; and where the mutated file is not part of a loop over all primitives of the other layout's image, it must
// be that loop's, bit for bit.
#include <array>
#include <set>

#include "harness/hit_cases.h"
#include "harness/mutation_oracles.h"
#include "harness/mutation_scenes.h"
#include "harness/walk_model.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "tracer/probe.h"
#include "tracer/shader_words.h"

namespace plumbline {

bool MutationOracle::sees(const Mutant& mutant) const {
  for (const ActiveLines& program : programs)
    if (is_active(program, mutant.file, mutant.line)) return true;
  return false;
}

namespace {

/// Files of the walk that a loop over all primitives of the other layout's image does without.
bool is_of_walk_alone(const std::string& file) {
  static const std::set<std::string> kFiles{
      "walk_compact.glsl", "walk_paper.glsl",  "bounds.glsl",        "bundle.glsl",      "bundle.frag.glsl",
      "bundle_space.glsl", "spread.frag.glsl", "image_compact.glsl", "image_paper.glsl", "change_space.glsl"};
  return kFiles.contains(file);
}

enum class Interruption { none, slices, loops };

struct Program {
  MutationScene scene;
  BakeOptions options;
  Traversal traversal = Traversal::tree;
  int bundle = 1;
  bool rare = false;   ///< rays that go on in the thorough program
  bool alike = false;  ///< each ray fills a bundle of its own, which walks as the ray does alone
  Interruption interruption = Interruption::none;  ///< with one the walk takes many passes
};

std::vector<ShaderPatch> patches_of(const GeometryImage& image, const Program& p) {
  // Enough to resume a walk and to leave an instance; in the heap some loop is then the one that brings a ray near.
  const int rounds = p.scene == MutationScene::heap ? 12 : 24;
  switch (p.interruption) {
    case Interruption::slices:
      return slices_of(image);
    case Interruption::loops:
      return loops_that_end(image, rounds);
    case Interruption::none:
      break;
  }
  return {};
}

std::string name_of(const Program& p, bool has_transforms) {
  std::string name = std::string(name_of(p.scene)) + "." + name_of(p.options.layout) + "_" + name_of(p.options.bounds) +
                     "_" + name_of(p.options.links);
  if (has_transforms) name += std::string("_") + name_of(p.options.transform_out);
  if (p.traversal == Traversal::brute_force) name += ".brute_force";
  if (p.bundle > 1) name += ".bundles_of_" + std::to_string(p.bundle);
  if (p.alike) name += ".alike";
  static constexpr std::array<const char*, 3> kInterruptions{"", ".sliced", ".loops_end"};
  name += kInterruptions[static_cast<std::size_t>(p.interruption)];
  return name + (p.rare ? ".rare" : "");
}

/// The first ray that does not walk as the model does.
std::string first_detour(const std::vector<ModelWalk>& model, const std::vector<Hit>& hits, bool is_alone) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = hits[i];
    if (!model[i].is_clear || hit.kind == HitKind::undefined) continue;
    const auto compare = [&](std::uint32_t got, std::uint32_t wanted, const char* what) {
      return got == wanted ? std::string()
                           : "ray " + std::to_string(i) + " has " + std::to_string(got) + " " + what + ", not " +
                                 std::to_string(wanted);
    };
    if (std::string e = compare(hit.steps, model[i].steps, "steps"); !e.empty()) return e;
    // Of bundles these are not counted.
    if (std::string e = compare(hit.primitive_tests, is_alone ? model[i].tests : 0, "primitive tests"); !e.empty())
      return e;
    if (std::string e = compare(hit.transforms, is_alone ? model[i].transforms : 0, "transforms"); !e.empty()) return e;
  }
  return {};
}

std::vector<ActiveLines> lines_of(const GeometryImage& image, const Program& p) {
  std::vector<ActiveLines> all;
  all.push_back(active_lines(probe_vertex_shader()));
  ProgramVariant first = program_variant(image, p.traversal == Traversal::brute_force, false), then = first;
  first.bundle = p.bundle;
  all.push_back(active_lines(probe_fragment_shader(first)));
  if (p.bundle > kBundleWithResults) {
    then.finish = true;
    all.push_back(active_lines(probe_fragment_shader(then)));
    then.finish = false;
  }
  then.thorough = true;
  if (p.rare || p.interruption != Interruption::none) all.push_back(active_lines(probe_fragment_shader(then)));
  return all;
}

std::vector<Hit> traced(Probe& probe, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  probe.trace(rays, hits);
  return hits;
}

/// Every ray `size` times, side by side; the last of its answers.
std::vector<Hit> traced_alike(Probe& probe, const std::vector<Ray>& rays, int size) {
  std::vector<Ray> many;
  for (const Ray& ray : rays) many.insert(many.end(), static_cast<std::size_t>(size), ray);
  const std::vector<Hit> hits = traced(probe, many);
  std::vector<Hit> last;
  for (std::size_t i = static_cast<std::size_t>(size) - 1; i < hits.size(); i += static_cast<std::size_t>(size))
    last.push_back(hits[i]);
  return last;
}

MutationOracle oracle_of(GlContext& context, const Program& p) {
  const MutationStage& stage = mutation_stage(context, p.scene);
  auto image = std::make_shared<const GeometryImage>(bake(stage.stage.scene, p.options));
  MutationOracle oracle;
  oracle.name = name_of(p, !stage.stage.scene.nodes.empty());
  oracle.programs = lines_of(*image, p);
  const MutationRays& rays = p.rare ? stage.rare : stage.plain;
  const bool drifts = p.options.transform_out == TransformOut::inverse;
  Program single = p;
  single.bundle = 1, single.rare = true;
  MutationOracle walks_alone;  // what a ray that walks alone runs
  walks_alone.programs = lines_of(*image, single);
  auto alone = std::make_shared<std::vector<Hit>>(), passed = std::make_shared<std::vector<Hit>>();
  if (p.bundle > 1 && drifts) {
    alone->resize(rays.rays.size());
    Probe(context, *image).trace(rays.rays, *alone);
  }
  std::vector<ModelWalk> model;
  // In layout `compact` a walk that has ended, but not the loops behind it, looks at its last texel once more.
  const bool looks_again = p.interruption == Interruption::loops && p.options.layout == Layout::compact;
  const bool is_counted = !looks_again && !p.rare && (p.bundle == 1 || p.alike);
  if (p.traversal == Traversal::tree && is_counted)
    for (const Ray& ray : rays.rays)
      model.push_back(is_defined(ray) ? model_walk(*image, ray) : ModelWalk{0, 0, 0, false});
  std::vector<Ray> clear;  // rays that end in the first pass, whoever walks with them
  for (std::size_t i = 0; i < model.size() && !drifts; ++i)
    if (model[i].is_clear && i < rays.odd_from) clear.push_back(rays.rays[i]);
  oracle.ask = [&context, &stage, &rays, image, p, drifts, walks_alone, alone, passed, model,
                clear](const Mutant& mutant) {
    // In the heap all is at one t, so that bounds tell little; but ends of loops must not change an answer.
    std::vector<Hit> undisturbed;
    if (p.scene == MutationScene::heap) {
      Probe probe(context, *image);
      undisturbed = traced(probe, rays.rays);
    }
    const AddedPatches added(context, patches_of(*image, p));
    Probe probe = p.bundle > 1 ? Probe(context, *image, BundleSize{p.bundle}) : Probe(context, *image, p.traversal);
    if (!clear.empty() && p.interruption == Interruption::none) {
      std::vector<Hit> ended(clear.size());
      probe.trace(clear, ended);
      if (probe.resumed_passes() > 0) return std::string("rays need another pass, though no triangle is seen edge-on");
    }
    std::vector<Hit> hits = p.alike ? traced_alike(probe, rays.rays, p.bundle) : traced(probe, rays.rays);
    if (!undisturbed.empty())
      if (const std::string what = first_difference(rays, hits, undisturbed); !what.empty()) return what;
    if (!model.empty())
      if (const std::string what = first_detour(model, hits, p.bundle == 1); !what.empty()) return what;
    if (drifts && p.bundle > 1) {
      // Bundles do not count what bounds of rays that drift hang on.
      if (!walks_alone.sees(mutant))
        if (const std::string what = first_difference(rays, hits, *alone); !what.empty()) return what;
      for (std::size_t i = 0; i < hits.size(); ++i) hits[i].transforms = (*alone)[i].transforms;
    } else if (is_of_walk_alone(mutant.file) && !drifts) {
      const std::vector<Hit>& known = p.options.layout == Layout::compact ? rays.brute_paper : rays.brute_compact;
      if (const std::string what = first_difference(rays, hits, known); !what.empty()) return what;
    }
    if (p.scene == MutationScene::doubles || p.scene == MutationScene::twins || p.scene == MutationScene::pairs)
      if (const std::string what = first_wrong_tie(stage.stage.scene, rays.rays, hits); !what.empty()) return what;
    return first_failure(stage.stage.judge_of(p.options.transform_out), rays, hits, *passed);
  };
  return oracle;
}

/// Of rays that wait for triangles seen edge-on, too: steps are visits of nodes, as counters at the nodes tell. These
/// count the leaf of an instance twice where another pass has to enter it.
MutationOracle visits(GlContext& context, MutationScene scene, const BakeOptions& options, bool waits_at_instances) {
  const MutationStage& stage = mutation_stage(context, scene);
  auto image = std::make_shared<const GeometryImage>(bake(stage.stage.scene, options));
  MutationOracle oracle;
  oracle.name = std::string("visits.") + name_of(scene) + "." + name_of(options.layout);
  for (const bool thorough : {false, true}) {
    ProgramVariant variant = program_variant(*image, false, thorough);
    variant.count_visits = true;
    oracle.programs.push_back(active_lines(probe_fragment_shader(variant)));
  }
  oracle.ask = [&context, &rays = stage.rare.rays, image, waits_at_instances](const Mutant&) -> std::string {
    VisitProbe probe(context, *image);
    std::vector<Hit> hits(rays.size());
    probe.trace(rays, hits);
    std::uint64_t steps = 0, counted = 0;
    for (const Hit& hit : hits) steps += hit.steps;
    for (const NodeVisits& node : probe.visits()) counted += node.visits;
    return steps == counted || (waits_at_instances && steps < counted)
               ? std::string()
               : std::to_string(steps) + " steps, but " + std::to_string(counted) + " visits of nodes";
  };
  return oracle;
}

}  // namespace

std::vector<MutationOracle> walk_oracles(GlContext& context) {
  using S = MutationScene;
  const auto with = [](Layout layout, Bounds bounds, Links links, TransformOut out = TransformOut::restore) {
    BakeOptions options;
    options.layout = layout, options.bounds = bounds, options.links = links, options.transform_out = out;
    options.width = 32;  // so that even small images have many rows
    return options;
  };
  const BakeOptions compact = with(Layout::compact, Bounds::sphere, Links::octant),
                    boxes = with(Layout::compact, Bounds::aabb, Links::threaded),
                    paper = with(Layout::paper, Bounds::sphere, Links::octant),
                    paper_boxes = with(Layout::paper, Bounds::aabb, Links::threaded),
                    drift = with(Layout::compact, Bounds::sphere, Links::octant, TransformOut::inverse),
                    boxes_drift = with(Layout::compact, Bounds::aabb, Links::octant, TransformOut::inverse),
                    paper_drift = with(Layout::paper, Bounds::aabb, Links::octant, TransformOut::inverse);
  const Traversal tree = Traversal::tree;
  std::vector<Program> programs{
      {S::spheres, compact},
      {S::mixed, compact},
      {S::triangles, boxes},
      {S::mixed, paper},
      {S::spheres, paper_boxes},
      {S::mixed, compact, tree, 1, true},
      {S::triangles, paper_boxes, tree, 1, true},
      {S::slats, compact, tree, 1, true},
      {S::mixed, compact, tree, 1, false, false, Interruption::slices},
      {S::mixed, paper, tree, 1, false, false, Interruption::slices},
      {S::nested, compact, tree, 1, false, false, Interruption::slices},
      {S::nested, paper, tree, 1, false, false, Interruption::slices},
      {S::nested, compact, tree, 1, false, false, Interruption::loops},
      {S::nested, paper, tree, 1, false, false, Interruption::loops},
      {S::nested, paper, tree, 1, true, false, Interruption::loops},
      {S::heap, compact, tree, 1, true, false, Interruption::loops},
      {S::nested, compact, tree, 2, false, false, Interruption::loops},
      {S::nested, compact, tree, 4, true, false, Interruption::loops},
      {S::slats, paper, tree, 1, true},
      {S::speck, compact, tree, 1, true},
      {S::giant, compact, tree, 1, true},
      {S::giant, paper, tree, 1, true},
      {S::apart, compact, tree, 1, true},
      {S::apart, drift, tree, 1, true},
      {S::apart, boxes, tree, 1, true},
      {S::pairs, compact},
      {S::pairs, paper_boxes, tree, 1, true},
      {S::twins, compact},
      {S::doubles, compact},
      {S::nested, compact},
      {S::nested, drift},
      {S::doubles, with(Layout::paper, Bounds::sphere, Links::threaded)},
      {S::nested, paper},
      {S::nested, compact, tree, 1, true},
      {S::nested, drift, tree, 1, true},
      {S::nested, paper_drift, tree, 1, true},
      {S::nested, boxes, tree, 1, true},
      {S::scales, compact, tree, 1, true},
      {S::scales, drift, tree, 1, true},
      {S::mixed, compact, tree, 2},
      {S::spheres, compact, tree, 2, false, true},
      {S::nested, drift, tree, 2, false, true},
      {S::triangles, boxes, tree, 3, false, true},
      {S::spheres, compact, tree, 2, true},
      {S::mixed, boxes, tree, 2},
      {S::nested, boxes, tree, 2},
      {S::nested, drift, tree, 2},
      {S::nested, boxes_drift, tree, 3},
      {S::mixed, compact, tree, 3, true},
      {S::spheres, paper, tree, 4, true},
      {S::nested, compact, tree, 2, true},
      {S::nested, drift, tree, 2, true},
      {S::nested, paper_drift, tree, 3, true},
      {S::nested, paper, tree, 4, true},
      {S::border, drift, tree, 2},
      {S::spheres_placed, drift, tree, 4},
  };
  std::vector<MutationOracle> oracles;
  for (const Program& p : programs) oracles.push_back(oracle_of(context, p));
  oracles.push_back(visits(context, S::slats, compact, false));
  oracles.push_back(visits(context, S::slats, paper, false));
  oracles.push_back(visits(context, S::apart, compact, true));
  return oracles;
}

}  // namespace plumbline
