// SPDX-License-Identifier: MIT
// Where things stand in a geometry image of layout `paper` (geometry_image.h). A primitive's address is its number k.

uniform sampler2D u_geometry;

vec4 cell_texel(int cell, int row) {
  return texelFetch(u_geometry, ivec2(cell & pass_image.x, (cell >> pass_image.y) * 2 + row), 0);
}
int primitive_cell(int address) { return pass_image.z + address * PRIMITIVE_STRIDE; }
vec4 primitive_0(int address) { return cell_texel(primitive_cell(address), 0); }
#ifdef HAS_TRIANGLES
vec4 primitive_1(int address) { return cell_texel(primitive_cell(address) + 1, 0); }
vec4 primitive_2(int address) { return cell_texel(primitive_cell(address), 1); }
#else
vec4 primitive_1(int address) { return cell_texel(primitive_cell(address), 1); }
#endif
int next_primitive(int address) { return address + 1; }
bool is_primitive(int address) { return address < pass_image.w; }
#ifdef HAS_TRANSFORMS
vec4 record_texel(int node, int i) {
  return cell_texel(pass_transforms.x + TRANSFORM_TEXELS / 2 * node + (i >> 1), i & 1);
}
#endif
