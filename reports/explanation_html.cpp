// SPDX-License-Identifier: MIT
// An explanation as a page: the document itself, and a script that draws it.
#include "reports/assets.h"
#include "reports/explanation.h"
#include "reports/format.h"
#include "reports/html_parts.h"

namespace plumbline {
namespace {

std::string facts(const ExplanationRecord& r) {
  std::string html = "<dl class=\"answers\">";
  const auto fact = [&](std::string_view name, std::string_view value) {
    if (!value.empty()) html += "<dt>" + html_escape(name) + "</dt><dd>" + html_escape(value) + "</dd>";
  };
  for (const auto& [who, text] : r.answers) fact(who, text);
  fact("verdict", r.verdict + (r.reason.empty() ? "" : ": " + r.reason));
  fact("image", r.image);
  fact("driver", r.driver);
  html += "</dl>";
  if (!r.crossings.empty()) {
    html += "<details><summary>What the ray's line meets, exactly</summary><ol>";
    for (const std::string& crossing : r.crossings) html += "<li>" + html_escape(crossing) + "</li>";
    html += "</ol></details>";
  }
  return html;
}

}  // namespace

std::string explanation_html(const ExplanationRecord& r) {
  const bool is_wrong = !r.layer.empty();
  const std::string headline = r.sentence.empty() ? "This ray has no answer" : r.sentence;
  std::string hero = std::string("<section id=\"verdict\" class=\"hero ") + (is_wrong ? "bad" : "good") +
                     "\"><div class=\"glyph\" aria-hidden=\"true\">" + (is_wrong ? "✗" : "✓") + "</div><div><h1>" +
                     html_escape(headline) + "</h1><p class=\"soft\">" +
                     (is_wrong ? "Layer: <b>" + html_escape(r.layer) + "</b>. " : "") + "Scene " +
                     html_escape(r.scene) + ", Plumbline " + html_escape(r.version) + "</p></div></section>";
  return page::filled(asset("explanation.html"),
                      {{"title", std::string(is_wrong ? "✗ " : "✓ ") + html_escape(headline)},
                       {"css", std::string(asset("report.css")) + std::string(asset("explanation.css"))},
                       {"hero", hero},
                       {"facts", facts(r)},
                       {"command", r.command.empty() ? "" : page::command_box(r.command)},
                       {"data", page::inside_script(explanation_to_json(r))},
                       {"js", std::string(asset("page.js")) + std::string(asset("explanation.js"))}});
}

}  // namespace plumbline
