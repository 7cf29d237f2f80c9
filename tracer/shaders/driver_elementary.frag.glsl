// SPDX-License-Identifier: MIT
// The functions of elementary.glsl.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  answer = floatBitsToUint(vec4(cos_sin_turns(v.x), cube_root(v.y), power(v.z, v.w)));
}
