// SPDX-License-Identifier: GPL-3.0-or-later
// An explanation for a terminal.
#include <cstdio>

#include "harness/explain.h"

namespace plumbline {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string place_of(int x, int y, std::uint32_t node, std::uint32_t space) {
  return "cell (" + std::to_string(x) + ", " + std::to_string(y) + ")" +
         (node == kNoNumber ? "" : ", node " + std::to_string(node)) +
         (space == kNoNumber ? "" : " behind transform " + std::to_string(space));
}

std::string step_text(const StepRecord& s, bool boxes) {
  std::string text = std::to_string(s.number) + ": " + place_of(s.x, s.y, s.node, s.space) + ": " + s.reason;
  if (s.again) text += ", the leaf once more";
  if (s.test != "end")
    text += boxes
                ? " (slabs " + number(s.enter) + " to " + number(s.leave) + ", nearest so far " + number(s.bound) + ")"
                : " (distance^2 " + number(s.distance2) + (s.test == "hit" ? " <= " : " against ") + "radius^2 " +
                      number(s.radius2) + ", nearest so far " + number(s.bound) + ")";
  for (const PrimitiveStepRecord& p : s.primitives) {
    text += "\n      primitive " + (p.primitive == kNoNumber ? "without a number" : std::to_string(p.primitive)) +
            ": " + p.outcome;
    if (p.outcome != "outside") text += " at t = " + number(p.t);
  }
  for (const SpaceStepRecord& c : s.changes) {
    const std::string node = c.node == kNoNumber ? "" : " transform " + std::to_string(c.node);
    text += "\n      " + (c.kind == "resumed" ? "goes on in another pass" : c.kind + node);
    if (c.kind == "entered")
      text += ", the ray there from (" + number(c.o[0]) + ", " + number(c.o[1]) + ", " + number(c.o[2]) + ") along (" +
              number(c.d[0]) + ", " + number(c.d[1]) + ", " + number(c.d[2]) + ")";
  }
  return text;
}

/// "name         text", the name once.
void line(std::string& out, const std::string& name, const std::string& text) {
  char padded[24];
  std::snprintf(padded, sizeof padded, "%-12s ", name.c_str());
  out += padded + text + "\n";
}

}  // namespace

std::string explanation_text(const ExplanationRecord& r, bool all_steps) {
  std::string t;
  line(t, "scene", r.scene);
  line(t, "image", r.image);
  line(t, "driver", r.driver);
  line(t, "ray", "--ray=" + r.ray[0] + "," + r.ray[1] + "," + r.ray[2]);
  for (const auto& [who, text] : r.answers) line(t, who, text);
  for (const std::string& crossing : r.crossings) line(t, "", crossing);
  line(t, "verdict", r.verdict);
  if (!r.reason.empty()) line(t, "", r.reason);

  const bool boxes = r.bounds == "aabb";
  std::size_t shown = 0;
  t += "\nThe walk, as captured: " + std::to_string(r.total_steps) + " steps\n";
  for (std::size_t i = 0; i < r.steps.size(); ++i) {
    const StepRecord& s = r.steps[i];
    if (!all_steps && !s.notable) continue;
    ++shown;
    t += std::string(i == r.fault.step ? "  > " : s.on_chain ? "  * " : "    ") + step_text(s, boxes) + "\n";
  }
  if (r.skipped > 0) t += "    " + std::to_string(r.skipped) + " later events were walked, but not captured\n";
  if (shown < r.total_steps)
    t += "    left out: " + std::to_string(r.total_steps - shown) + " of " + std::to_string(r.total_steps) + " steps" +
         (all_steps ? "" : " that miss or only pass through; --all prints them") + "\n";
  if (!r.driver_agrees) t += "    The driver's pixels that walked this ray came to different ends.\n";
  if (!r.chain.empty()) {
    t += "\nThe nodes above the truth, primitive " + std::to_string(r.truth_primitive) + " (* in the walk)\n";
    for (const AncestorRecord& a : r.chain) {
      const StepRecord* step = a.step < r.steps.size() ? &r.steps[a.step] : nullptr;
      t += "    " + place_of(a.x, a.y, a.node, a.space) + ": " +
           (step ? "step " + std::to_string(step->number) + ", " + step->reason : "not visited");
      if (a.transform != kNoNumber) t += "; leads into transform " + std::to_string(a.transform);
      t += "\n";
    }
  }
  t += "\n";
  line(t, "in short", r.sentence.empty() ? "the ray has no answer" : r.sentence);
  if (!r.layer.empty()) line(t, "layer", r.layer);
  if (r.against) {
    t += "\nAgainst " + r.against->with + " (" + r.against->note +
         "): " + (r.against->same ? "no difference" : r.against->sentence) + "\n";
    if (r.against->first) t += "    this   " + step_text(*r.against->first, boxes) + "\n";
    if (r.against->second) t += "    other  " + step_text(*r.against->second, boxes) + "\n";
    if (!r.against->second_answer.empty()) line(t, "other", r.against->second_answer);
  }
  return t;
}

}  // namespace plumbline
