// SPDX-License-Identifier: MIT
// Numbers and text as people and file formats want them: grouped thousands, short counts, durations, escapes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace plumbline {

std::string grouped(std::uint64_t count);                             ///< "20,480,000"
std::string counted(std::uint64_t count, std::string_view singular);  ///< "1 ray", "2,000 rays"
std::string short_count(std::uint64_t count);  ///< "812", "76.5k", "20.5M": at most five characters up to 10^12
std::string percent(std::uint64_t part,
                    std::uint64_t whole);  ///< "0.021 %"; never "0 %" for a part above 0, nor "100 %" for less than all
std::string duration(double seconds);      ///< "3 ms", "4.2 s", "9 min 12 s", "2 h 5 min"
std::string value_text(double value);      ///< four significant digits: "0.5521", "2,345", "1.2e-9", "nan"
std::string fixed(double value, int digits);  ///< plain decimal, in the C locale

/// `text` with every ill-formed UTF-8 sequence replaced by U+FFFD, so that JSON, XML and HTML take it.
std::string valid_utf8(std::string_view text);
/// For text and double-quoted attributes of HTML.
std::string html_escape(std::string_view text);
/// For text and double-quoted attributes of XML 1.0; characters that XML forbids become U+FFFD, line breaks are kept.
std::string xml_escape(std::string_view text);

std::string base64(std::string_view bytes);  ///< RFC 4648, padded

}  // namespace plumbline
