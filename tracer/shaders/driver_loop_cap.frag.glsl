// SPDX-License-Identifier: MIT
// Counts to 200,000, in one loop and in nested ones.

layout(location = 0) out uvec4 answer;

void main() {
  int pixel = int(gl_FragCoord.x);
  int single = 0, nested = 0;
  for (int i = 0; i < 200000 + pixel; ++i) single += 1;
  for (int i = 0; i < 200; ++i) {
    for (int k = 0; k < 1000; ++k) nested += 1;
  }
  answer = uvec4(single, nested, 0, 0);
}
