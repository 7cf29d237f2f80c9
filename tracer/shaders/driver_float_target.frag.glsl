// SPDX-License-Identifier: MIT
// Writes a float texel to a float target.

uniform sampler2D u_input;
layout(location = 0) out vec4 answer;

void main() { answer = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0); }
