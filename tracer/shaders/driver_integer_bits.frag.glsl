// SPDX-License-Identifier: MIT
// Integers to float bits and back, and the integer arithmetic of the ray preparation.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  int bits = floatBitsToInt(texelFetch(u_input, ivec2(gl_FragCoord.xy), 0).x);
  float round_trip = intBitsToFloat(bits);
  answer = uvec4(floatBitsToUint(round_trip), floatBitsToUint(float(bits & 0x7fffff)), bits >> 23, floatBitsToUint(-abs(round_trip)));
}
