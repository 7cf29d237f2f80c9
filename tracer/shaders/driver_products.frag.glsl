// SPDX-License-Identifier: MIT
// Products, their difference and a sum, each rounded on its own: nothing fused, nothing reordered.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  float forward = v.x * v.y - v.z * v.w;
  float backward = v.z * v.w - v.x * v.y;
  float sum = (v.x * v.y + v.z * v.w) + v.x * v.w;
  answer = floatBitsToUint(vec4(forward, backward, sum, v.x * v.y));
}
