// SPDX-License-Identifier: MIT
// What bundles of two have written, side by side as their rays stand.

uniform usampler2D u_found_0, u_found_1, u_found_2, u_found_3, u_found_4, u_found_5;
#ifdef HAS_TRANSFORMS
uniform usampler2D u_found_6, u_found_7;
layout(location = 3) out uvec4 out_3;
#endif
layout(location = 0) out uvec4 out_0;
layout(location = 1) out uvec4 out_1;
layout(location = 2) out uvec4 out_2;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 at = ivec2(pixel.x >> 1, pixel.y);
  bool is_second = (pixel.x & 1) != 0;
#ifdef HAS_TRANSFORMS
  out_0 = is_second ? texelFetch(u_found_4, at, 0) : texelFetch(u_found_0, at, 0);
  out_1 = is_second ? texelFetch(u_found_5, at, 0) : texelFetch(u_found_1, at, 0);
  out_2 = is_second ? texelFetch(u_found_6, at, 0) : texelFetch(u_found_2, at, 0);
  out_3 = is_second ? texelFetch(u_found_7, at, 0) : texelFetch(u_found_3, at, 0);
#else
  out_0 = is_second ? texelFetch(u_found_3, at, 0) : texelFetch(u_found_0, at, 0);
  out_1 = is_second ? texelFetch(u_found_4, at, 0) : texelFetch(u_found_1, at, 0);
  out_2 = is_second ? texelFetch(u_found_5, at, 0) : texelFetch(u_found_2, at, 0);
#endif
}
