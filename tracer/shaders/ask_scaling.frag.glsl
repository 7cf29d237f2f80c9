// SPDX-License-Identifier: MIT
// Scaling by powers of two (exact.glsl): x * 2^e, and the bits of |x| * 2^e, denormals included.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  int e = int(v.y);
  float magnitude = intBitsToFloat(floatBitsToInt(v.x) & 0x7fffffff);
  answer = uvec4(floatBitsToUint(scale_exactly(v.x, e)), scaled_bits(magnitude, e), 0u, 0u);
}
