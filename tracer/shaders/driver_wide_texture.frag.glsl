// SPDX-License-Identifier: MIT
// Reads texels spread over a texture 16384 wide, by number and by texture coordinates with the half texel baked in.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  int i = (pixel.y * 64 + pixel.x) * 8 + (pixel.x & 7);
  ivec2 place = ivec2(i & 16383, i >> 14);
  float by_number = texelFetch(u_input, place, 0).x;
  float by_link = textureLod(u_input, (vec2(place) + 0.5) / vec2(16384.0, 2.0), 0.0).x;
  answer = uvec4(floatBitsToUint(by_number), floatBitsToUint(by_link), 0, 0);
}
