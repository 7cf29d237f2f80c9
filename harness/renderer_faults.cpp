// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/renderer_faults.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "harness/clock.h"
#include "harness/depths.h"
#include "harness/help.h"
#include "reports/files.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

// What shows an effect best: the paired comparison, the independent one, densities.
const std::string kSoft = "soft_shadow.soft_shadow", kLens = "dof.dof", kGlossy = "glossy.glossy";
// Faults of random numbers are put into both sources of them, and the image of noise must show its own.
const std::string kNoiseImage = "drt.densities.tracer_texture.soft_shadow.paper";

RendererFaultResult witnessed(const SeededRendererFault& fault, std::uint64_t seed, const std::filesystem::path& out,
                              const std::function<void(double)>& progress) {
  CatalogueOptions options = nightly_catalogue();
  options.fault = fault.fault;
  const std::vector<Case> cases = select_cases(make_catalogue(options), fault.cases);
  RendererFaultResult result{fault.name, fault.what, {}, 0.0};
  const auto start = Clock::now();
  Session session;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    CaseContext context{session, seed, out, [&](double share) {
                          progress((static_cast<double>(i) + share) / static_cast<double>(cases.size()));
                        }};
    CaseRecord record;
    record.name = cases[i].name;
    cases[i].run(context, cases[i], record);
    result.witnesses.push_back({cases[i].name, record.status == CaseStatus::failed, record.message});
  }
  result.seconds = seconds_since(start);
  return result;
}

}  // namespace

bool RendererFaultResult::caught() const {
  return std::any_of(witnesses.begin(), witnesses.end(), [](const RendererFaultWitness& w) { return w.caught; });
}

std::vector<SeededRendererFault> renderer_faults(const std::vector<std::string>& only) {
  const auto paired = [](const std::string& what) { return "drt.paired." + what; };
  const auto independent = [](const std::string& what) { return "drt.independent." + what; };
  const auto densities = [](const std::string& what) { return "drt.densities.tracer_hash." + what; };
  const std::string light = "light.frag.glsl", camera = "camera.frag.glsl", scatter = "scatter.frag.glsl",
                    places = "perturbation.glsl", random = "random.glsl";
  std::vector<SeededRendererFault> faults;
  const auto add = [&](const char* name, const char* what, std::vector<ShaderPatch> patches,
                       std::vector<std::string> cases) {
    faults.push_back({name, what, {std::move(patches), {}}, std::move(cases)});
  };
  add("light_radius", "lights are 3 % too large", {{light, "q += place.w * p;", "q += 1.03 * place.w * p;"}},
      {paired(kSoft), independent(kSoft + ".physical")});
  add("aperture", "the lens is 3 % too wide",
      {{camera, "vec3 p = u_eye.w * in_lens", "vec3 p = 1.03 * u_eye.w * in_lens"}},
      {paired(kLens), independent(kLens + ".physical")});
  add("glossiness", "reflections are 5 % too rough",
      {{scatter, "vec3 p = in_ball(used.xyz);", "vec3 p = 1.05 * in_ball(used.xyz);"}},
      {paired(kGlossy), independent(kGlossy + ".physical")});
  const std::string ball = "return cube_root(u.z) * vec3(s * cos_sin_turns(u.y), 1.0 - 2.0 * u.x);";
  add("light_cube", "a cube of lights where the physical model has a ball", {{places, ball, "return in_cube(u);"}},
      {paired(kSoft), independent(kSoft + ".physical"), densities("soft_shadow.physical")});
  add("light_surface", "lights are on the ball's surface, not in its volume",
      {{places, "return cube_root(u.z) * vec3(", "return vec3("}},
      {paired(kSoft), independent(kSoft + ".physical"), densities("soft_shadow.physical")});
  add("lens_no_root", "the physical lens is sampled by radius, without the square root",
      {{places, "sqrt(u.x) * cos_sin_turns(u.y), 0.0", "u.x * cos_sin_turns(u.y), 0.0"}},
      {paired(kLens), independent(kLens + ".physical"), densities("dof.physical")});
  add("light_is_lens", "light and lens use the same random numbers",
      {{light, "uint(u_sample.y), BLOCK_LIGHTS + uint(light)", "1u, BLOCK_LENS"}},
      {"drt.pairs.soft_shadow_dof.figure_1", "drt.all.figure_1.physical"});
  add("noise_kept", "the noise is not renewed: every frame has the numbers of the first",
      {{random, "key + uvec4(pixel, frame, 0u, 0u)", "key + uvec4(pixel, 0u, 0u, 0u)"},
       {random, "uint layer = frame - uint(u_random.w);", "uint layer = 0u;"}},
      {independent(kSoft + ".paper"), densities("soft_shadow.paper"), independent("texture." + kSoft + ".paper"),
       kNoiseImage});
  add("neighbours_share", "pairs of neighbouring pixels use the same random numbers",
      {{random, "key + uvec4(pixel, frame, 0u, 0u)", "key + uvec4(pixel & ~1u, frame, 0u, 0u)"},
       {random, "return (pixel + which * NOISE_STRIDE)", "return ((pixel & ~1u) + which * NOISE_STRIDE)"}},
      {independent(kSoft + ".paper"), densities("soft_shadow.paper"), kNoiseImage});
  add("half_pixel", "samples are shifted by half a pixel", {{camera, "(used.xy - 0.5)", "used.xy"}},
      {paired("aa.bumped_ground"), independent("aa.bumped_ground.paper"), "drt.closed_form.aa.slanted_bars.paper"});
  faults.push_back({"half_shutter",
                    "the shutter is open in its first half only",
                    {{},
                     [](Scene& scene) {
                       scene.camera.shutter_close = 0.5f * (scene.camera.shutter_open + scene.camera.shutter_close);
                     }},
                    {independent("motion_blur.motion.paper")}});
  add("light_centre", "shadow rays go towards the light's centre",
      {{light, "out_1 = is_asked ? vec4(q - start, 0.0)", "out_1 = is_asked ? vec4(place.xyz - start, 0.0)"}},
      {paired(kSoft), independent(kSoft + ".physical")});
  add("highlight", "the highlight is computed with the perturbed normal",
      {{light, "float cosine = dot(s.n, unit(l - s.from.d));",
        "float cosine = dot(unit(s.n + s.glossy * in_ball(random_block(pixel_number(), frame_number(), "
        "uint(u_sample.y), BLOCK_NORMAL).xyz)), unit(l - s.from.d));"}},
      {paired(kGlossy), independent(kGlossy + ".paper")});
  add("not_mirrored", "a reflected ray that goes into the surface is not mirrored above it",
      {{scatter, "inwards < 0.0 ? mirrored - 2.0 * inwards * s.facing : mirrored", "mirrored"}},
      {paired("glossy.bumped_ground"), independent(kGlossy + ".paper"), "drt.closed_form.glossy.grazing.paper"});
  add("eight_bits", "frames are kept in 8 bits before they are averaged",
      {{"accumulate.frag.glsl",
        "  return texelFetch(u_samples, ivec2(pixel.x * lanes + i % lanes, i / lanes * u_layout.y + pixel.y), 0);",
        "  vec4 given = texelFetch(u_samples, ivec2(pixel.x * lanes + i % lanes, i / lanes * u_layout.y + pixel.y), "
        "0);\n"
        "  return vec4(floor(clamp(given.xyz, 0.0, 1.0) * 255.0 + 0.5) / 255.0, given.w);"}},
      {independent(kSoft + ".paper")});
  add("depth_4", "reflections end one bounce early",
      {{scatter, "bool reflects = s.is_hit && s.ks > 0.0;",
        "bool reflects = s.is_hit && s.ks > 0.0 && u_sample.y < 16;"}},
      {"drt.independent.bounces.mirrors.paper"});
  std::set<std::string> known;
  for (const SeededRendererFault& fault : faults) known.insert(fault.name);
  for (const std::string& name : only)
    if (!known.contains(name)) {
      const std::string meant = words_alike(name, known);
      throw InputError(
          "there is no fault '" + name + "'; " +
          (meant.empty() ? "`plumbline faults --pictures` seeds them all" : "did you mean " + meant + "?"));
    }
  if (!only.empty())
    std::erase_if(faults, [&](const auto& f) { return std::find(only.begin(), only.end(), f.name) == only.end(); });
  return faults;
}

ShaderPatch renderer_patch(const std::string& name) {
  for (const SeededRendererFault& fault : renderer_faults())
    if (fault.name == name && fault.fault.patches.size() == 1) return fault.fault.patches.front();
  throw InputError("no fault of one patch is called '" + name + "'");
}

void run_renderer_faults(std::uint64_t seed, std::vector<SeededRendererFault> faults,
                         const std::function<void(double, const std::string&)>& progress,
                         const std::function<void(const RendererFaultResult&)>& ended) {
  SeededRendererFault sound{"sound", "the renderer as it is", {}, {}};
  std::set<std::string> cases;
  for (const SeededRendererFault& fault : faults) cases.insert(fault.cases.begin(), fault.cases.end());
  sound.cases.assign(cases.begin(), cases.end());
  faults.insert(faults.begin(), std::move(sound));

  double all = 0.0, done = 0.0;
  for (const SeededRendererFault& fault : faults) all += static_cast<double>(fault.cases.size());
  const ScratchFolder folder("plumbline-faults");
  for (const SeededRendererFault& fault : faults) {
    const auto count = static_cast<double>(fault.cases.size());
    ended(witnessed(fault, seed, folder.path(),
                    [&](double share) { progress((done + share * count) / all, fault.name); }));
    done += count;
  }
}

}  // namespace plumbline
