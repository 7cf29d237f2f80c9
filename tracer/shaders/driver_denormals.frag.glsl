// SPDX-License-Identifier: MIT
// Arithmetic with denormal operands and results.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  answer = floatBitsToUint(vec4(v.x * v.y, v.x + v.x, v.z * 0.25, v.x > 0.0 ? 1.0 : 0.0));
}
