// SPDX-License-Identifier: MIT
// The same chains, walked as the production shader walks: a pixel leaves a loop before it changes what the loop depends
// on.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  int at = pixel.x * 7 + pixel.y * 13;
  int sum = 0, rounds = 0;
  for (;;) {
    vec4 value = vec4(0.0);
    for (;;) {
      value = texelFetch(u_input, ivec2(at & 63, at >> 6), 0);
      if (!(value.w > 0.0)) break;
      at += int(value.x);
    }
    at += int(value.x);
    sum = sum * 3 + int(value.y);
    ++rounds;
    if (rounds > int(value.z)) break;
  }
  answer = uvec4(sum, at, rounds, 0);
}
