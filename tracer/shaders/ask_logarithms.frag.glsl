// SPDX-License-Identifier: MIT
// The two halves of power() (elementary.glsl), each for itself: log2 of x, 2^y.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  answer = uvec4(floatBitsToUint(vec2(log_2(v.x), exp_2(v.y))), 0u, 0u);
}
