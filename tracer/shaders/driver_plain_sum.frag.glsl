// SPDX-License-Identifier: MIT
// (a + b) - a, written plainly: a compiler that takes it for b loses the rounding error.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  answer = uvec4(floatBitsToUint((v.x + v.y) - v.x), 0, 0, 0);
}
