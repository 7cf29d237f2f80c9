// SPDX-License-Identifier: MIT
// What a misspelt word was meant to be.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline {

/// How many letters must be put in, taken out or exchanged to make one word of the other (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// " (did you mean 'scale'?)" where one of the known words is near, else empty.
std::string did_you_mean(std::string_view word, std::initializer_list<std::string_view> known);
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

}  // namespace plumbline
