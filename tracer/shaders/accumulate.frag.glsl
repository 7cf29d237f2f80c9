// SPDX-License-Identifier: MIT
// Adds samples of each pixel to its sums, in the order of frames. Of the samples x, with x0 the first, two sums are kept:
// of x - x0 and of (x - x0)^2, each as a float and what rounding took from it. Nothing overflows in the first, which is
// kept 2^12 times smaller. Samples that are not finite stay out of the sums; flags tell of them.

uniform sampler2D u_samples;
uniform sampler2D u_kept_0, u_kept_1, u_kept_2, u_kept_3;
uniform ivec4 u_layout;  // lanes, rows of the tile; first of the samples to be added, and their end
uniform int u_is_new;    // 1: nothing is kept yet

layout(location = 0) out vec4 out_0;  // x0, flags
layout(location = 1) out vec4 out_1;  // sum of x - x0, and the low part of x
layout(location = 2) out vec4 out_2;  // sum of the squares, and the low part of y
layout(location = 3) out vec4 out_3;  // the squares' low part, and the low part of z

const float kSmall = 0.000244140625;  // 2^-12
const float kLarge = 4096.0;

struct Sum {
  vec3 high, low;
};

// Adds value + error, of which `error` is the rounding error of `value` or as small. Of the sum s no more than
// 7 * 2^-48 |s| is lost.
Sum plus(Sum a, vec3 value, vec3 error) {
  vec3 s = a.high + value;
  vec3 low = a.low + (sum_error(a.high, value, s) + error);
  vec3 high = s + low;
  return Sum(high, sum_error(s, low, high));
}

// Three bits of each channel: NaN, infinity, minus infinity. Finite channels have none.
uvec3 kinds_of(uvec3 bits) {
  uvec3 is_special = uvec3(equal(bits & 0x7f800000u, uvec3(0x7f800000u)));
  uvec3 is_nan = uvec3(notEqual(bits & 0x7fffffu, uvec3(0u)));
  return is_special * (is_nan + (1u - is_nan) * (uvec3(2u) << (bits >> 31u)));
}

// Zero where it is not finite, chosen among integers: a driver may let NaN through where it chooses among floats.
vec3 finite_part(uvec3 bits, uvec3 kinds) { return uintBitsToFloat(bits * uvec3(equal(kinds, uvec3(0u)))); }

vec4 sample_of_pixel(int i) {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  int lanes = u_layout.x;
  return texelFetch(u_samples, ivec2(pixel.x * lanes + i % lanes, i / lanes * u_layout.y + pixel.y), 0);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 first = vec3(0.0);
  Sum sum = Sum(vec3(0.0), vec3(0.0)), squares = sum;
  uint flags = 0u;
  if (u_is_new == 0) {
    vec4 a = texelFetch(u_kept_0, pixel, 0), b = texelFetch(u_kept_1, pixel, 0);
    vec4 c = texelFetch(u_kept_2, pixel, 0), d = texelFetch(u_kept_3, pixel, 0);
    first = a.xyz;
    flags = uint(a.w);
    sum = Sum(b.xyz, vec3(b.w, c.w, d.w));
    squares = Sum(c.xyz, d.xyz);
  } else {
    uvec3 bits = floatBitsToUint(sample_of_pixel(u_layout.z).xyz);
    first = finite_part(bits, kinds_of(bits));
  }
  for (int i = u_layout.z; i < u_layout.w; ++i) {
    vec4 given = sample_of_pixel(i);
    uvec3 bits = floatBitsToUint(given.xyz), kinds = kinds_of(bits);
    flags |= kinds.x | kinds.y << 3u | kinds.z << 6u | (given.w > 0.0 ? 512u : 0u);
    // Opaque, else the difference may be made smaller after it has overflowed.
    vec3 x = opaque(finite_part(bits, kinds) * kSmall), minus = opaque(-first * kSmall);
    vec3 difference = opaque(x + minus);
    vec3 error = sum_error(x, minus, difference);
    sum = plus(sum, difference, error);
    vec3 d = difference * kLarge;
    vec3 square = opaque(d * d);
    squares = plus(squares, square, product_error(d, d, square) + 2.0 * d * (error * kLarge));
  }
  out_0 = vec4(first, float(flags));
  out_1 = vec4(sum.high, sum.low.x);
  out_2 = vec4(squares.high, sum.low.y);
  out_3 = vec4(squares.low, sum.low.z);
}
