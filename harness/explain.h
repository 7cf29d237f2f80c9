// SPDX-License-Identifier: GPL-3.0-or-later
// One ray, told in full: what the tracer answers, what a loop over all primitives answers, what Embree answers, what
// exact arithmetic says, the verdict, the tracer's own walk, and where it parts from the truth.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "harness/compare_walks.h"
#include "harness/layers.h"
#include "harness/session.h"
#include "reports/explanation.h"
#include "tracer/shader_source.h"

namespace plumbline {

/// Reads "ox,oy,oz,dx,dy,dz" or with ",t_max" behind it; decimal or hex floats. Throws InputError for anything else.
Ray parse_ray(const std::string& text);

/// The ray through the centre of pixel "x,y" of the scene's camera. Throws InputError for a pixel outside the picture.
Ray pixel_ray(const Scene& scene, const std::string& text);

/// The tracer that is asked. Everything must outlive the Examiner.
struct Examined {
  const Stage* stage = nullptr;          ///< the scene and the truth
  const GeometryImage* image = nullptr;  ///< that is walked
  const GeometryImage* sound = nullptr;  ///< a bake of the same shape that is known to be right; null: none at hand
  std::span<const ShaderPatch> patches;  ///< of the shader: faults on purpose
  std::string source;                    ///< "baked now", or the file that it was read from
};

struct Explanation {
  Ray ray;
  Hit tracer, brute;
  bool has_brute = false;  ///< false: the scene shows too many primitives for a loop over all
  ReferenceHit reference;
  Judgement judgement;
  Walk walk;
  ExpectedHit expected;      ///< the truth; primitive kNone: a miss
  std::optional<Loss> loss;  ///< where the truth is a hit
  Layer layer = Layer::none;
  std::string sentence;
  bool is_wrong = false;  ///< by its verdict, or since the loop over all primitives answers something else
};

/// Explains rays, one after another, with programs that are compiled once.
class Examiner {
 public:
  Examiner(Session& session, const Examined& examined);
  ~Examiner();

  /// Of walks with more events than `most_events` the beginning is captured.
  Explanation explain(const Ray& ray, std::size_t most_events = kMostEvents);
  /// The record of an explanation, with at most `most_steps` steps.
  ExplanationRecord record(const Explanation& explanation, const std::string& command,
                           std::size_t most_steps = std::numeric_limits<std::size_t>::max()) const;
  const Examined& examined() const { return examined_; }

 private:
  Session& session_;
  Examined examined_;
  std::optional<Probe> patched_, patched_brute_;
  WalkRecorder recorder_;
};

/// The explanation for a terminal: notable steps, or every one.
std::string explanation_text(const ExplanationRecord& record, bool all_steps);

}  // namespace plumbline
