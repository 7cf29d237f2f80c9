// SPDX-License-Identifier: MIT
// Follows chains of different lengths through a texture, and reads after the inner loop what its last round fetched.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  int at = pixel.x * 7 + pixel.y * 13;
  int sum = 0, rounds = 0;
  for (;;) {
    vec4 value;
    do {
      value = texelFetch(u_input, ivec2(at & 63, at >> 6), 0);
      at += int(value.x);
    } while (value.w > 0.0);
    sum = sum * 3 + int(value.y);
    ++rounds;
    if (rounds > int(value.z)) break;
  }
  answer = uvec4(sum, at, rounds, 0);
}
