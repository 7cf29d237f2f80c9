// SPDX-License-Identifier: MIT
// See github.h.
#include "reports/github.h"

#include "reports/format.h"
#include "reports/summary.h"

namespace plumbline {
namespace {

std::string encoded(std::string_view text, std::string_view marks) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string out;
  for (const char c : valid_utf8(text)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '%' || c == '\n' || c == '\r' || marks.find(c) != std::string_view::npos)
      out += {'%', kHex[byte >> 4], kHex[byte & 15u]};
    else
      out += byte < 0x20 || byte == 0x7f ? ' ' : c;
  }
  return out;
}

std::string command(const char* name, std::string_view title, std::string_view message) {
  return "::" + std::string(name) + " title=" + github_property(title) + "::" + github_message(message) + "\n";
}

}  // namespace

std::string github_message(std::string_view text) { return encoded(text, ""); }

std::string github_property(std::string_view text) { return encoded(text, ":,"); }

std::string github_annotations(const RunRecord& run) {
  std::string out;
  std::size_t failing = 0;
  for (const CaseRecord& record : run.cases) {
    if (!is_failure(outcome(record)) || ++failing > kMostGithubErrors) continue;
    const std::string replay = record.replay.empty() ? "" : "\nreplay: " + record.replay;
    out += command("error", record.name, message_of(record) + replay);
  }
  std::string total = headline(summarize(run));
  if (failing > kMostGithubErrors)
    total += " " + grouped(failing - kMostGithubErrors) + " of these are in the report only.";
  return out + command("notice", "Plumbline", total);
}

}  // namespace plumbline
