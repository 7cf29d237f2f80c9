# SPDX-License-Identifier: MIT
# Writes the C++ source that holds text files as string literals. Called at build time:
#   cmake -DOUTPUT=assets.cpp "-DFILES=a|b" -P embed_assets.cmake
string(REPLACE "|" ";" FILES "${FILES}")
set(entries "")
foreach(file IN LISTS FILES)
  file(READ "${file}" text)
  string(FIND "${text}" ")asset\"" clash)
  if(NOT clash EQUAL -1)
    message(FATAL_ERROR "${file} contains the end mark of the literal that embeds it")
  endif()
  get_filename_component(name "${file}" NAME)
  string(APPEND entries "  if (name == \"${name}\") return R\"asset(${text})asset\";\n")
endforeach()
file(WRITE "${OUTPUT}" "// Written by embed_assets.cmake; do not edit.
#include \"reports/assets.h\"
#include \"scenes/error.h\"

namespace plumbline {

std::string_view asset(std::string_view name) {
${entries}  PLUMBLINE_ASSERT(!\"an embedded file\");
}

}  // namespace plumbline
")
