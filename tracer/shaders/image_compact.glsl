// SPDX-License-Identifier: MIT
// Where things stand in a geometry image of layout `compact` (geometry_image.h). A primitive's address is its number k.

uniform sampler2D u_geometry;
uniform int u_width_mask;   // width - 1
uniform int u_width_shift;  // log2(width)
uniform int u_primitive_start;
uniform int u_primitive_count;

vec4 texel(int i) { return texelFetch(u_geometry, ivec2(i & u_width_mask, i >> u_width_shift), 0); }

int primitive_texel(int address) { return u_primitive_start + address * PRIMITIVE_STRIDE; }
vec4 primitive_0(int address) { return texel(primitive_texel(address)); }
vec4 primitive_1(int address) { return texel(primitive_texel(address) + 1); }
#ifdef HAS_TRIANGLES
vec4 primitive_2(int address) { return texel(primitive_texel(address) + 2); }
#endif
int next_primitive(int address) { return address + 1; }
bool is_primitive(int address) { return address < u_primitive_count; }
