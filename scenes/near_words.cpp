// SPDX-License-Identifier: MIT
#include "scenes/near_words.h"

#include <algorithm>
#include <limits>

namespace plumbline {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (a[i] == b[j] ? 0u : 1u)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

namespace {

template <class Words>
std::string nearest_word(std::string_view word, const Words& known) {
  std::string_view best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  constexpr std::size_t kLongest = 64;  // no key of ours is longer; junk of a megabyte is not compared
  for (const std::string_view candidate : known) {
    if (word.size() > kLongest || candidate.size() > kLongest) continue;
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) least = distance, best = candidate;
  }
  // A third of the letters may be wrong, and one always.
  if (best.empty() || least > std::max<std::size_t>(1, best.size() / 3)) return {};
  return " (did you mean '" + std::string(best) + "'?)";
}

}  // namespace

std::string did_you_mean(std::string_view word, std::initializer_list<std::string_view> known) {
  return nearest_word(word, known);
}
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  return nearest_word(word, known);
}

}  // namespace plumbline
