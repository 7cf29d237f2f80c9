// SPDX-License-Identifier: MIT
// Reciprocal, quotient and square root.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  answer = floatBitsToUint(vec4(1.0 / v.x, v.y / v.x, sqrt(abs(v.x)), 0.0));
}
