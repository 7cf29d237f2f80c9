// SPDX-License-Identifier: MIT
// The error-free sums and products of exact.glsl.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;

void main() {
  vec4 v = texelFetch(u_input, ivec2(gl_FragCoord.xy), 0);
  vec3 sum = vec3(v.x + v.y);
  float product = v.x * v.y;
  // Terms with a common factor: z (x + y) is no x z + y z.
  PRECISE vec3 a = vec3(v.x * v.z), b = vec3(v.y * v.z);
  PRECISE vec3 of_products = a + b;
  answer = floatBitsToUint(vec4(sum_error(vec3(v.x), vec3(v.y), sum).x, product_error(v.x, v.y, product),
                                difference_of_products(v.x, v.y, v.z, v.w), sum_error(a, b, of_products).x));
}
