# SPDX-License-Identifier: MIT
# Puts the shader files into a C++ source, so that the program runs from anywhere: cmake -DFILES=a;b -DOUTPUT=x.cpp -P embed_shaders.cmake
set(text "// Made by embed_shaders.cmake.\n#include \"tracer/embedded_shaders.h\"\n\nnamespace plumbline {\nnamespace {\nconstexpr EmbeddedShader kShaders[] = {\n")
foreach(file IN LISTS FILES)
  file(READ ${file} content)
  get_filename_component(name ${file} NAME)
  string(APPEND text "{\"${name}\", R\"glsl(${content})glsl\"},\n")
endforeach()
string(APPEND text "};\n}  // namespace\nstd::span<const EmbeddedShader> embedded_shaders() { return kShaders; }\n}  // namespace plumbline\n")
file(WRITE ${OUTPUT} "${text}")
