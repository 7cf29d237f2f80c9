// SPDX-License-Identifier: MIT
// Where things stand in a geometry image of layout `compact` (geometry_image.h). A primitive's address is its number k.

#ifdef BUFFER_TEXTURES
// The image is linear, and a buffer texture has no second coordinate and no levels of detail to compute: 13 % faster
// over all.
uniform samplerBuffer u_geometry;
vec4 texel(int i) { return texelFetch(u_geometry, i); }
#else
uniform sampler2D u_geometry;
vec4 texel(int i) { return texelFetch(u_geometry, ivec2(i & pass_image.x, i >> pass_image.y), 0); }
#endif

int primitive_texel(int address) { return pass_image.z + address * PRIMITIVE_STRIDE; }
vec4 primitive_0(int address) { return texel(primitive_texel(address)); }
vec4 primitive_1(int address) { return texel(primitive_texel(address) + 1); }
#ifdef HAS_TRIANGLES
vec4 primitive_2(int address) { return texel(primitive_texel(address) + 2); }
#endif
int next_primitive(int address) { return address + 1; }
bool is_primitive(int address) { return address < pass_image.w; }
#ifdef HAS_TRANSFORMS
vec4 record_texel(int node, int i) { return texel(pass_transforms.x + TRANSFORM_TEXELS * node + i); }
#endif
