// SPDX-License-Identifier: GPL-3.0-or-later
#include "harness/explain.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "harness/exact_view.h"
#include "harness/hit_cases.h"
#include "scenes/camera.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

/// Comma-separated floats, each read whole. strtof takes hex floats, nan and inf.
std::vector<float> parse_floats(const std::string& text, const char* option) {
  std::vector<float> values;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, end - at);
    char* rest = nullptr;
    const float value = std::strtof(part.c_str(), &rest);
    if (part.empty() || *rest != '\0') throw InputError(std::string(option) + ": '" + part + "' is not a number");
    values.push_back(value);
    at = end + 1;
  }
  return values;
}

template <class... Args>
void print(std::string& text, const char* format, Args... args) {
  char line[512];
  std::snprintf(line, sizeof line, format, args...);
  text += line;
}

void print_values(std::string& text, const char* who, const std::string& answer, bool hit, const glm::dvec3& position,
                  const glm::dvec3& normal) {
  print(text, "%-12s %s\n", who, answer.c_str());
  if (!hit) return;
  print(text, "%-12s position (%.9g, %.9g, %.9g), normal (%.9g, %.9g, %.9g)\n", "", position.x, position.y, position.z,
        normal.x, normal.y, normal.z);
}

}  // namespace

Ray parse_ray(const std::string& text) {
  const std::vector<float> v = parse_floats(text, "--ray");
  if (v.size() != 6 && v.size() != 7)
    throw InputError("--ray takes 6 or 7 numbers, OX,OY,OZ,DX,DY,DZ[,TMAX]; there are " + std::to_string(v.size()));
  Ray ray{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  if (v.size() == 7) ray.t_max = v[6];
  return ray;
}

Ray pixel_ray(const Scene& scene, const std::string& text) {
  const std::vector<float> v = parse_floats(text, "--pixel");
  if (v.size() != 2) throw InputError("--pixel takes two numbers, X,Y");
  const Camera& c = scene.camera;
  if (v[0] != std::floor(v[0]) || v[1] != std::floor(v[1]))
    throw InputError("--pixel takes whole numbers, X,Y; they are '" + text + "'");
  if (!(v[0] >= 0.0f && v[0] < static_cast<float>(c.width) && v[1] >= 0.0f && v[1] < static_cast<float>(c.height)))
    throw InputError("--pixel " + text + " is outside the picture of " + std::to_string(c.width) + " x " +
                     std::to_string(c.height) + " pixels");
  return camera_ray(c, v[0], v[1]);
}

Explanation explain(Session& session, const Stage& stage, const Ray& ray, TransformOut out) {
  const std::span<const Ray> rays(&ray, 1);
  Hit hit, brute;
  ReferenceHit reference;
  session.probe(stage, out).trace(rays, {&hit, 1});
  session.brute_force(stage).trace(rays, {&brute, 1});
  stage.embree.intersect(rays, {&reference, 1});

  Explanation e;
  const Judge judge_data = stage.judge_of(out);
  e.judgement = judge(judge_data, ray, hit, reference, true);
  std::string& t = e.text;
  print(t, "scene        %s, %zu triangles, %zu spheres\n", stage.scene.name.c_str(), stage.scene.triangles.size(),
        stage.scene.spheres.size());
  if (!stage.scene.nodes.empty())
    print(t, "             in %zu parts, shown by %zu instances; in units of its own space what an instance resolves\n",
          stage.scene.parts.size(), instances_of(stage.scene).size());
  print(t, "ray          from (%.9g, %.9g, %.9g) along (%.9g, %.9g, %.9g), t_max %.9g\n", ray.origin.x, ray.origin.y,
        ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z, ray.t_max);
  print(t, "             --ray=%s\n", ray_argument(ray).c_str());
  print_values(t, "tracer", describe(hit), hit.kind == HitKind::hit, hit.position, hit.normal);
  print(t, "             %u cells visited, %u primitives tested", hit.steps, hit.primitive_tests);
  if (stage.scene.nodes.empty())
    t += "\n";
  else
    print(t, ", %u transforms entered (way out: %s)\n", hit.transforms, name_of(out));
  print_values(t, "brute force", describe(brute), brute.kind == HitKind::hit, brute.position, brute.normal);
  print_values(t, "Embree", describe(reference), reference.kind == HitKind::hit, reference.position, reference.normal);
  if (!e.judgement.exact.empty()) print(t, "exact        %s\n", e.judgement.exact.c_str());
  if (is_defined(ray)) {
    const ExactView view(judge_data, ray, left_by(judge_data, hit));
    std::size_t shown = 0;
    for (const Crossing& c : view.crossings()) {
      if (++shown > 16) {
        print(t, "             and %zu more\n", view.crossings().size() - 16);
        break;
      }
      const std::string name = primitive_name(stage.scene, c.instance, c.primitive);
      print(t, "             %s %s at t = %.17g, %s by %.3g (32 bits resolve %.3g)%s\n",
            stage.scene.is_triangle(c.primitive) ? "triangle," : "sphere,", name.c_str(), c.t,
            c.margin < 0.0 ? "passed" : "met inside its outline", std::abs(c.margin), view.lateral(c),
            c.nearest      ? ", nearest"
            : c.in_plane   ? ", seen exactly edge-on"
            : c.facing < 0 ? ", front"
            : c.facing > 0 ? ", back"
                           : "");
    }
  }
  print(t, "verdict      %s\n", std::string(verdict_name(e.judgement.verdict)).c_str());
  if (!e.judgement.reason.empty()) print(t, "             %s\n", e.judgement.reason.c_str());
  if (e.judgement.verdict == Verdict::grazing)
    print(t, "             margin %.3g, bound %.3g\n", e.judgement.margin, e.judgement.bound);
  return e;
}

}  // namespace plumbline
