// SPDX-License-Identifier: MIT
// Functions that drivers give without a stated precision, from sums and products alone. Below, u is 2^-24, half a unit
// in the last place of 1. The bounds are the tests' bounds too (elementary_test.cpp).

// Cosine and sine of `turn` whole turns, turn in [0, 1) a multiple of 2^-24: within 2 u of the truth, exact at quarters.
vec2 cos_sin_turns(float turn) {
  // The nearest quarter, and what remains of it: exact, since 4 * turn is.
  float quarter = floor(4.0 * turn + 0.5);
  float r = 4.0 * turn - quarter;  // in [-1/2, 1/2]
  // Taylor in r^2; the terms left out are below 2^-29.
  float z = r * r;
  float s = r * (1.57079632679 + z * (-0.645964097506 + z * (0.0796926262461 + z * (-0.00468175413532 + z * 0.000160441184787))));
  float c = 1.0 + z * (-1.23370055014 + z * (0.253669507901 + z * (-0.0208634807634 + z * (0.000919260274839 - z * 0.0000252020423731))));
  int which = int(quarter) & 3;
  vec2 turned = (which & 1) == 0 ? vec2(c, s) : vec2(-s, c);
  return (which & 2) == 0 ? turned : -turned;
}

// The cube root of x, 0 or in [2^-100, 1]: within 2 u of it, relatively.
float cube_root(float x) {
  // A third of the exponent is off by 3.2 % at most; each of two steps of Halley's makes less than its cube of that.
  float y = intBitsToFloat(floatBitsToInt(x) / 3 + 0x2a510800);
  float cube = y * y * y;
  y = y * ((cube + 2.0 * x) / (2.0 * cube + x));
  cube = y * y * y;
  y = y + y * ((x - cube) / (2.0 * cube + x));
  return x > 0.0 ? y : 0.0;
}

// log2 of a normal number x > 0: within 3 u of it, relatively, near 1 too.
float log_2(float x) {
  // x = 2^e (1 + f), f exact and between sqrt(1/2) - 1 and sqrt(2) - 1.
  int bits = floatBitsToInt(x) - 0x3f3504f3;
  int e = bits >> 23;
  float f = intBitsToFloat((bits & 0x7fffff) + 0x3f3504f3) - 1.0;
  // ln(1 + f) = 2 artanh(s) = 2 s + s R(s^2) = f - s (f - R): f carries no error, and what is taken from it is small.
  float s = f / (2.0 + f);
  float z = s * s;
  float rest = z * (0.666666666667 + z * (0.4 + z * (0.285714285714 + z * 0.222222222222)));
  return float(e) + 1.44269504089 * (f - s * (f - rest));
}

// 2^x for |x| <= 252: within 2 u of it, relatively; below 2^-126 it may be 0.
float exp_2(float x) {
  float whole = floor(x + 0.5);
  float f = x - whole;  // exact
  float p = 1.0 + f * (0.69314718056 + f * (0.240226506959 + f * (0.0555041086648 + f * (0.00961812910763 + f * (0.00133335581464 + f * (0.000154035303934 + f * (0.0000152527338041 + f * 0.00000132154867901)))))));
  int first = int(whole) / 2, second = int(whole) - first;
  return p * intBitsToFloat((first + 127) << 23) * intBitsToFloat((second + 127) << 23);
}

// x^y for x in [0, 1 + 2^-20], finite y >= 0; 0^0 = 1. With v = x^y the error is at most v (2 + 4 y |ln x|) u: absolutely,
// never more than 2.5 u where x <= 1, whatever y. Results below 2^-126 may be 0, and x below 2^-126 may count as 0.
float power(float x, float y) {
  float v = exp_2(clamp(y * log_2(x), -252.0, 252.0));
  return y == 0.0 ? 1.0 : (x > 0.0 ? v : 0.0);
}
