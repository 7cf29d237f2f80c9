// SPDX-License-Identifier: MIT
// Arithmetic whose rounding errors are known or zero. Compilers may take real-number algebra for float algebra and turn
// (a + b) - a into b; a sum that passes through `opaque` can't be seen through. That is not enough where a and b are
// products: a common factor is taken out of all of it (Mesa 22.3 and 25.0), so the terms are PRECISE too. Where there is no
// such word, in GLSL ES, `opaque` is all. Denormals may be flushed to zero by any operation.

float opaque(float x) { return x * pass_factor.x; }
vec3 opaque(vec3 x) { return x * pass_factor.x; }

// a + b - sum exactly, where sum = fl(a + b) (Knuth), per component.
vec3 sum_error(vec3 a, vec3 b, vec3 sum) {
  PRECISE vec3 z = opaque(sum) - a;
  PRECISE vec3 error = (a - opaque(sum - z)) + (b - z);
  return error;
}

// The upper 12 of a float's 24 significant bits: products of two such halves are exact.
float upper_half(float x) { return intBitsToFloat(floatBitsToInt(x) & int(0xfffff000u)); }
vec3 upper_half(vec3 x) { return intBitsToFloat(floatBitsToInt(x) & ivec3(int(0xfffff000u))); }

// a * b - product exactly, where product = fl(a * b) (Dekker).
float product_error(float a, float b, float product) {
  float ah = upper_half(a), bh = upper_half(b);
  PRECISE float al = a - ah, bl = b - bh;
  PRECISE float error = (((ah * bh - product) + ah * bl) + al * bh) + al * bl;
  return error;
}
vec3 product_error(vec3 a, vec3 b, vec3 product) {
  vec3 ah = upper_half(a), bh = upper_half(b);
  PRECISE vec3 al = a - ah, bl = b - bh;
  PRECISE vec3 error = (((ah * bh - product) + ah * bl) + al * bh) + al * bl;
  return error;
}

// a * b - c * d with a relative error of a few units in the last place, its sign and its zero exact (short of
// underflow).
float difference_of_products(float a, float b, float c, float d) {
  PRECISE float p = a * b, q = c * d;
  float pe = product_error(a, b, p), qe = product_error(c, d, q);
  PRECISE float high = opaque(p - q);
  PRECISE float high_z = opaque(high - p);
  PRECISE float high_error = (p - opaque(high - high_z)) - (q + high_z);
  PRECISE float low = opaque(pe - qe);
  PRECISE float low_z = opaque(low - pe);
  PRECISE float low_error = (pe - opaque(low - low_z)) - (qe + low_z);
  PRECISE float result = opaque(high + (high_error + low)) + low_error;
  return result;
}

// 2^e, e in [-126, 127].
float power_of_two(int e) { return intBitsToFloat((e + 127) << 23); }

// |x| as mantissa * 2^exponent, exactly, for every finite x, denormals included: mantissa is 0 or in [1, 2^23).
float split_exponent(int bits, out int exponent) {
  int field = (bits >> 23) & 255;
  int fraction = bits & 0x7fffff;
  exponent = field == 0 ? -149 : field - 127;
  return field == 0 ? float(fraction) : intBitsToFloat(fraction | 0x3f800000);
}

// x * 2^e: exact where the result is normal; below 2^-126 it may be flushed to zero, above the largest float it is
// infinite. x may be denormal; infinity stays.
float scale_exactly(float x, int e) {
  int bits = floatBitsToInt(x);
  int exponent;
  float mantissa = split_exponent(bits, exponent);
  int total = clamp(exponent + e, -252, 252);
  int first = total / 2;
  float magnitude = mantissa * power_of_two(first) * power_of_two(total - first);
  return exponent == 128 ? x : intBitsToFloat(floatBitsToInt(magnitude) | (bits & int(0x80000000u)));
}
vec3 scale_exactly(vec3 v, int e) { return vec3(scale_exactly(v.x, e), scale_exactly(v.y, e), scale_exactly(v.z, e)); }

// The bits of x * 2^e, x >= 0, rounded to the nearest float, denormals included: for results that leave the shader.
uint scaled_bits(float x, int e) {
  int exponent;
  float mantissa = split_exponent(floatBitsToInt(x), exponent);
  int total = exponent + e;
  int top = total + ((floatBitsToInt(mantissa) >> 23) & 255) - 127;  // the exponent of the result
  float denormal = floor(mantissa * power_of_two(clamp(total + 149, -126, 127)) + 0.5);
  return top < -126 ? uint(denormal) : floatBitsToUint(scale_exactly(x, e));
}
