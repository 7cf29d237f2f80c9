// SPDX-License-Identifier: MIT
// Comparisons with NaN: every one is false but "not equal".

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  float nan = (v.x - v.x) / (v.y - v.y);
  uint n = 0u;
  if (nan < v.z) n |= 1u;
  if (nan > v.z) n |= 2u;
  if (nan <= v.z) n |= 4u;
  if (nan >= v.z) n |= 8u;
  if (nan == v.z) n |= 16u;
  if (nan != v.z) n |= 32u;
  if (!(nan <= v.z)) n |= 64u;
  answer = uvec4(n, 0, 0, 0);
}
