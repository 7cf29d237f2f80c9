// SPDX-License-Identifier: MIT
// A first walk over an OBJ file: tinyobjloader gives no line numbers, takes what is no number for 0 and reads out of
// bounds on bad indices, so every statement is checked here before it sees the file. Internal to the OBJ reader.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/text_file.h"

namespace plumbline {

/// A name that a statement gives, and its line.
struct NamedLine {
  std::string name;
  std::size_t line = 0;
};

/// Where things stand, in the order of the file, which is the order of tinyobjloader's callbacks.
struct ObjScan {
  std::vector<std::size_t> face_lines;    ///< of each f statement with at least one corner
  std::vector<std::size_t> usemtl_lines;  ///< of each usemtl statement with a name
  std::vector<NamedLine> libraries;       ///< of each mtllib statement
  std::vector<std::string> warnings;      ///< what is in the file and not read
};

/// Throws InputError with the line for the first statement that is wrong: a coordinate that is no finite number, an
/// index out of range, a control character.
ObjScan scan_obj(const std::string& file, const std::vector<TextLine>& lines);

/// Throws InputError where a line has a control character: it is no text. Comments may have them.
void check_text(const std::string& file, const TextLine& line);

}  // namespace plumbline
