// SPDX-License-Identifier: MIT
// SHA-256 (FIPS 180-4), to see whether a file is what was written.
#pragma once

#include <string>
#include <string_view>

namespace plumbline {

/// 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

}  // namespace plumbline
