// SPDX-License-Identifier: GPL-3.0-or-later
// Which lines of a shader's files a driver really compiles: what is left of them once #if has been obeyed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tracer/shader_source.h"

namespace plumbline {

/// Of each file, by line - 1: whether the line is compiled.
using ActiveLines = std::map<std::string, std::vector<bool>>;

/// Conditions may use defined, whole numbers, macros that stand for such, and ! && || == != < > <= >= ( ). Throws
/// InputError for others.
ActiveLines active_lines(const ShaderText& shader);

bool is_active(const ActiveLines& lines, const std::string& file, int line);

}  // namespace plumbline
