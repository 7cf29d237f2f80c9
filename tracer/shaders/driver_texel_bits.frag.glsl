// SPDX-License-Identifier: MIT
// Hands on the bits of a float texel.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() { answer = floatBitsToUint(texelFetch(u_input, ivec2(gl_FragCoord.xy), 0)); }
