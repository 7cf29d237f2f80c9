// SPDX-License-Identifier: MIT
// Once per ray: the ray as given becomes the ray that walks. Everything that depends on the ray alone is computed here.

// The walking ray is the set of points o + t d in image units. Its t and the ray's own are related by
//   t_given = (t * shift_unit + shift_low + shift_high) * 2^exponent.
struct WalkRay {
  vec3 o;
  vec3 d;      // the direction as given times a power of two: its largest component is in [1, 2)
  vec3 dn;     // d / dot(d, d): dot(x, dn) is the t of the point of the ray next to x
  float inverse_d2;  // 1 / dot(d, d)
  vec3 shear;  // d.x / d.z, d.y / d.z, 1 / d.z after permutation: the largest component is z
  int axis;    // which component that is
  float t_low;   // hits need t > t_low
  float t_best;  // and t <= t_best, to begin with
  float shift_high, shift_low, shift_unit;
  int exponent;
  bool defined;  // false: the ray has no answer (SEMANTICS 1.3)
  bool misses;   // true: the ray misses the scene's ball, or ends before it
  bool too_far;  // true: the origin is so far away that only the thorough program moves it near enough
#ifdef HAS_TRANSFORMS
  // t of the world's walking ray = t * t_scale + t_shift: the t by which hits in different spaces are compared. t_scale
  // is a power of two.
  float t_scale, t_shift;
  bool cut;  // true: the driver ended a loop before its time, so that this ray is not to be used
#endif
#ifdef BOUNDS_AABB
  vec3 slabs;  // 1 / d, made finite (bounds.glsl)
#endif
};

// All arithmetic that leads to a walking ray or a hit is done as written: programs of other variants, compiled with other code around it, must come
// to the same bits.
PRECISE WalkRay ray;

// The components in an order that puts the ray's largest last, keeping the handedness.
vec3 permute(vec3 v) { return ray.axis == 0 ? v.yzx : ray.axis == 1 ? v.zxy : v.xyz; }

bool is_finite(ivec3 magnitude) { return max(max(magnitude.x, magnitude.y), magnitude.z) < 0x7f800000; }

// Moves the origin of a far ray along it to two radii before the point next to the ball's centre. In floats
// alone o + t d would be off by |o| 2^-24, so products and sums are taken with their rounding errors. Where the step
// ends matters little, but it misses its aim by up to 2^-21 of its length; from beyond 10^4 radii another step or more
// follow, with origin and shift carried as unevaluated sums (high + low) of some 48 bits. Everything is scaled by 2^-8
// that nothing overflows.
void approach(vec4 ball, bool is_far) {
  vec3 center = ball.xyz * SHIFT_UNIT;
  vec3 start = ray.o * SHIFT_UNIT;
  float back = 2.0 * ball.w * SHIFT_UNIT * sqrt(ray.inverse_d2);
  float advance = dot(center - start, ray.dn) - back;
  vec3 product = advance * ray.d;
  vec3 sum = opaque(start + product);
  vec3 rest = sum_error(start, product, sum) + product_error(vec3(advance), ray.d, product);
  vec3 high = opaque(sum + rest);
  float shift_high = advance, shift_low = 0.0;
  ray.too_far = is_far && abs(advance) > 32768.0 * back;
#ifdef THOROUGH
  vec3 low = sum_error(sum, rest, high);
  bool is_moving = ray.too_far;
  int rounds = 0;
  for (; rounds < 8 && is_moving; ++rounds) {
    advance = dot((center - high) - low, ray.dn) - back;
    product = advance * ray.d;
    sum = opaque(high + product);
    low = low + (sum_error(high, product, sum) + product_error(vec3(advance), ray.d, product));
    high = opaque(sum + low);
    low = sum_error(sum, low, high);
    float t_sum = opaque(shift_high + advance);
    float z = opaque(t_sum - shift_high);
    shift_low = shift_low + ((shift_high - opaque(t_sum - z)) + (advance - z));
    shift_high = t_sum;
    is_moving = abs(advance) > 32768.0 * back;
  }
  high = high + low;
  ray.too_far = false;
#ifdef HAS_TRANSFORMS
  ray.cut = is_moving && rounds < 8;
#endif
#endif
  if (is_far) {
    ray.o = high * (1.0 / SHIFT_UNIT);
    ray.shift_high = shift_high;
    ray.shift_low = shift_low;
    ray.shift_unit = SHIFT_UNIT;
    ray.exponent += SHIFT_EXPONENT;
  }
}

// Components so small beside the largest that products of them would be flushed to zero here and not there, which would
// turn a triangle's edge functions into noise. They move the ray by 2^-60 of the scene's size, far less than its
// rounding.
const float NEGLIGIBLE = 8.673617379884035e-19;
vec3 drop_below(vec3 v, float least) { return mix(v, vec3(0.0), lessThan(abs(v), vec3(least))); }

// What follows from the direction alone.
void set_direction(vec3 direction) {
  ray.d = direction;
  ray.inverse_d2 = 1.0 / dot(ray.d, ray.d);
  ray.dn = ray.d * ray.inverse_d2;
  vec3 size = abs(ray.d);
  ray.axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  vec3 p = permute(ray.d);
  float inverse = 1.0 / p.z;
  ray.shear = vec3(p.x * inverse, p.y * inverse, inverse);
}

int largest_bits(vec3 v) {
  ivec3 magnitude = floatBitsToInt(v) & ivec3(0x7fffffff);
  return max(max(magnitude.x, magnitude.y), magnitude.z);
}

// Makes the walking ray of the line from `origin` along `direction` in a space whose contents lie in `ball`. All is
// finite, the direction is not zero.
void aim_ray(vec3 origin, vec3 direction, vec4 ball) {
  int exponent;
  float mantissa = split_exponent(largest_bits(direction), exponent);
  exponent += ((floatBitsToInt(mantissa) >> 23) & 255) - 127;
  set_direction(drop_below(scale_exactly(direction, -exponent), NEGLIGIBLE));
  ray.o = drop_below(origin, NEGLIGIBLE * ball.w);
  ray.exponent = -exponent;
  ray.shift_high = 0.0;
  ray.shift_low = 0.0;
  ray.shift_unit = 1.0;
  vec3 m = ball.xyz - ray.o;
  bool is_far = !(dot(m, m) <= 4.0 * ball.w * ball.w);  // an overflow is far
  bool leaves = is_far && dot(m * SHIFT_UNIT, ray.dn) <= 0.0;
  approach(ball, is_far && !leaves);

  // A far ray whose point next to the centre lies outside the ball misses; 1.25 covers the error of the walking origin.
  m = ball.xyz - ray.o;
  vec3 f = m - dot(m, ray.dn) * ray.d;
  bool passes = is_far && !(dot(f, f) <= 1.5625 * ball.w * ball.w);
  ray.t_low = is_far ? -3.0e38 : 0.0;  // the contents lie before a far ray's walking origin
  ray.misses = leaves || passes;
}

void prepare_ray(vec3 origin, vec3 direction, float t_max) {
  ivec3 o_magnitude = floatBitsToInt(origin) & ivec3(0x7fffffff);
  ivec3 d_magnitude = floatBitsToInt(direction) & ivec3(0x7fffffff);
  int t_magnitude = floatBitsToInt(t_max) & 0x7fffffff;
  int largest = max(max(d_magnitude.x, d_magnitude.y), d_magnitude.z);
  ray.defined = is_finite(o_magnitude) && is_finite(d_magnitude) && t_magnitude <= 0x7f800000 && largest > 0;
  // What has no answer is replaced by something harmless, so that no NaN walks.
  origin = ray.defined ? origin : pass_ball.xyz;
  direction = ray.defined ? direction : vec3(0.0, 0.0, 1.0);
  t_max = ray.defined ? t_max : 0.0;
  aim_ray(pass_range.x == 0 ? origin : scale_exactly(origin, pass_range.x), direction, pass_ball);
  ray.exponent -= pass_range.x;
  float t_end = scale_exactly(t_max, -ray.exponent);
  ray.t_best = ((t_end - ray.shift_high) - ray.shift_low) * (1.0 / ray.shift_unit);
  ray.misses = ray.misses || !(ray.t_best > 0.0);
#ifdef HAS_TRANSFORMS
  ray.t_scale = 1.0;
  ray.t_shift = 0.0;
  ray.cut = false;
#endif
}

// The octant of a direction: bit a is set where component a is negative.
int octant_of(vec3 d) { return (d.x < 0.0 ? 1 : 0) + (d.y < 0.0 ? 2 : 0) + (d.z < 0.0 ? 4 : 0); }

// t as the ray's own, never above its t_max: the bits of a float.
uint given_t(float t, float t_max) {
  float sum = (t * ray.shift_unit + ray.shift_low) + ray.shift_high;
  return min(scaled_bits(max(sum, 0.0), ray.exponent), floatBitsToUint(t_max));
}
