// SPDX-License-Identifier: MIT
// Random numbers of (pixel, frame, ray, block), which stand in the texels as whole numbers.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  uvec4 of = uvec4(texelFetch(u_input, ivec2(gl_FragCoord.xy), 0));
  answer = floatBitsToUint(random_block(of.x, of.y, of.z, of.w));
}
