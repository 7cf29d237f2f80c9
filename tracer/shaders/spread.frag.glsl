// SPDX-License-Identifier: MIT
// What bundles have written, side by side as their rays stand: all results of two rays, or the kinds of up to four.

uniform usampler2D u_found_0, u_found_1;
#if !defined(BUNDLE_KINDS) || BUNDLE_SIZE > 2
uniform usampler2D u_found_2;
#endif
#if !defined(BUNDLE_KINDS) || BUNDLE_SIZE > 3
uniform usampler2D u_found_3;
#endif
#ifndef BUNDLE_KINDS
uniform usampler2D u_found_4, u_found_5;
#ifdef HAS_TRANSFORMS
uniform usampler2D u_found_6, u_found_7;
#endif
#endif
layout(location = 0) out uvec4 out_0;
layout(location = 1) out uvec4 out_1;
layout(location = 2) out uvec4 out_2;
#ifdef HAS_TRANSFORMS
layout(location = 3) out uvec4 out_3;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 at = ivec2(pixel.x / BUNDLE_SIZE, pixel.y);
  int lane = pixel.x - BUNDLE_SIZE * at.x;
#ifdef BUNDLE_KINDS
  // Words of zero: what is unfinished has no label, and begins anew.
  out_0 = lane == 0 ? texelFetch(u_found_0, at, 0) : texelFetch(u_found_1, at, 0);
#if BUNDLE_SIZE > 2
  if (lane == 2) out_0 = texelFetch(u_found_2, at, 0);
#endif
#if BUNDLE_SIZE > 3
  if (lane == 3) out_0 = texelFetch(u_found_3, at, 0);
#endif
  out_1 = uvec4(0u);
  out_2 = uvec4(0u);
#ifdef HAS_TRANSFORMS
  out_3 = uvec4(0u);
#endif
#elif defined(HAS_TRANSFORMS)
  out_0 = lane == 0 ? texelFetch(u_found_0, at, 0) : texelFetch(u_found_4, at, 0);
  out_1 = lane == 0 ? texelFetch(u_found_1, at, 0) : texelFetch(u_found_5, at, 0);
  out_2 = lane == 0 ? texelFetch(u_found_2, at, 0) : texelFetch(u_found_6, at, 0);
  out_3 = lane == 0 ? texelFetch(u_found_3, at, 0) : texelFetch(u_found_7, at, 0);
#else
  out_0 = lane == 0 ? texelFetch(u_found_0, at, 0) : texelFetch(u_found_3, at, 0);
  out_1 = lane == 0 ? texelFetch(u_found_1, at, 0) : texelFetch(u_found_4, at, 0);
  out_2 = lane == 0 ? texelFetch(u_found_2, at, 0) : texelFetch(u_found_5, at, 0);
#endif
}
