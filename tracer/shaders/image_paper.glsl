// SPDX-License-Identifier: MIT
// Where things stand in a geometry image of layout `paper` (geometry_image.h). A primitive's address is its number k.

uniform sampler2D u_geometry;
uniform int u_width_mask;   // width - 1
uniform int u_width_shift;  // log2(width)
uniform float u_texel_width, u_texel_height;  // 1 / width, 1 / height
uniform int u_primitive_start;
uniform int u_primitive_count;

vec4 cell_texel(int cell, int row) {
  return texelFetch(u_geometry, ivec2(cell & u_width_mask, (cell >> u_width_shift) * 2 + row), 0);
}
int primitive_cell(int address) { return u_primitive_start + address * PRIMITIVE_STRIDE; }
vec4 primitive_0(int address) { return cell_texel(primitive_cell(address), 0); }
#ifdef HAS_TRIANGLES
vec4 primitive_1(int address) { return cell_texel(primitive_cell(address) + 1, 0); }
vec4 primitive_2(int address) { return cell_texel(primitive_cell(address), 1); }
#else
vec4 primitive_1(int address) { return cell_texel(primitive_cell(address), 1); }
#endif
int next_primitive(int address) { return address + 1; }
bool is_primitive(int address) { return address < u_primitive_count; }
