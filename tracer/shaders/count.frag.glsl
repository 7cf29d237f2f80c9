// SPDX-License-Identifier: MIT
// Draws the pixels of a pass that have something left to do, for a query to count.

#ifdef COUNT_UNFINISHED
uniform usampler2D u_hit_0;
bool is_counted() { return (texelFetch(u_hit_0, ivec2(gl_FragCoord.xy), 0).x & 7u) == KIND_UNFINISHED; }
#else
uniform sampler2D u_ray_directions;
bool is_counted() { return texelFetch(u_ray_directions, ivec2(gl_FragCoord.xy), 0).xyz != vec3(0.0); }
#endif

layout(location = 0) out vec4 out_0;

void main() {
  if (!is_counted()) discard;
  out_0 = vec4(1.0);
}
