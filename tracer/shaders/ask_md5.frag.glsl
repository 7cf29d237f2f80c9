// SPDX-License-Identifier: MIT
// The MD5 digests of messages of one block: 16 words each, in the four texels of a row.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

uvec4 words(int i) { return floatBitsToUint(texelFetch(u_input, ivec2(i, int(gl_FragCoord.y)), 0)); }

void main() { answer = md5_block(words(0), words(1), words(2), words(3)); }
