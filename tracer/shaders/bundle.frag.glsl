// SPDX-License-Identifier: MIT
// One bundle per pixel: rays come from a texture. Drivers have eight targets. Of two rays these hold all that there is to
// tell (result.glsl), the first ray's before the second's. Of more rays the nearest hit of each goes to two; what follows
// from it, position and normal, is another pass's to compute. Of shadow rays only the kind of the hit is asked: one target.

// Of ray k, targets 2 k and 2 k + 1: t (in the space of the hit), label (negative: the ray must walk alone), address,
// steps of the bundle; weights, t and space by the world's count (candidate.glsl).
layout(location = 0) out uvec4 out_0;
layout(location = 1) out uvec4 out_1;
#if !defined(BUNDLE_KINDS) || BUNDLE_SIZE > 2
layout(location = 2) out uvec4 out_2;
#endif
#if !defined(BUNDLE_KINDS) || BUNDLE_SIZE > 3
layout(location = 3) out uvec4 out_3;
#endif
#if !defined(BUNDLE_KINDS) && (BUNDLE_SIZE > 2 || defined(BUNDLE_RESULTS))
layout(location = 4) out uvec4 out_4;
layout(location = 5) out uvec4 out_5;
#endif
#if !defined(BUNDLE_KINDS) && (BUNDLE_SIZE > 3 || (defined(BUNDLE_RESULTS) && defined(HAS_TRANSFORMS)))
layout(location = 6) out uvec4 out_6;
layout(location = 7) out uvec4 out_7;
#endif

void begin(int number) {
  vec4 origin_and_end = ray_texel(2 * number);
  prepare_ray(origin_and_end.xyz, ray_texel(2 * number + 1).xyz, origin_and_end.w);
  start();
  rest.in_space = REST_NONE;
  rest.alone = false;
}

// Sets those aside that have no way to go, and those that this program can't take along.
bool is_anyone_walking;
void settle(int octant) {
  bool is_over = !ray.defined || (ray.misses && !ray.too_far);
  bool is_alone = ray.too_far;
#ifdef HAS_TRANSFORMS
  is_alone = is_alone || ray.cut || walks_elsewhere(octant_of(ray.d), octant);
#endif
  if (is_over || is_alone) rest_for_good(!is_over);
  is_anyone_walking = is_anyone_walking || rest.in_space == REST_NONE;
}

#ifdef BUNDLE_KINDS
// Of the ray at hand: kind, 0, steps of the bundle, 0.
uvec4 kind_of_ray() {
  bool hit = nearest.label < NO_LABEL;
  bool is_alone = !walk.ended || rest.alone || (nearest.pending >= 0 && !hit);
  uint kind = !ray.defined ? KIND_UNDEFINED : hit ? KIND_HIT : KIND_MISS;
  return uvec4(is_alone ? KIND_UNFINISHED : kind, 0u, walk.steps, 0u);
}
#define WRITE(K, A) TAKE_RAY(K) A = kind_of_ray();
#elif defined(BUNDLE_RESULTS)
// Of the ray at hand; where another pass must trace it, a state without a label.
void make_result(float t_max) {
  bool waits = nearest.pending >= 0;
  bool complete = write_result(t_max);
  result_0.w = 0u;  // tests and transforms are the bundle's, not its own
#ifdef HAS_TRANSFORMS
  result_3.y = 0u;
#endif
  if (!walk.ended || rest.alone || waits || !complete) {
    result_0 = uvec4(KIND_UNFINISHED, 0u, walk.steps, 0u);
    result_1 = uvec4(0u);
    result_2 = uvec4(0u);
  }
}
#ifdef HAS_TRANSFORMS
#define WRITE(K, A, B, C, D) TAKE_RAY(K) make_result(ray_texel(2 * (first + K)).w); A = result_0, B = result_1, C = result_2, D = result_3;
#else
#define WRITE(K, A, B, C) TAKE_RAY(K) make_result(ray_texel(2 * (first + K)).w); A = result_0, B = result_1, C = result_2;
#endif
#else
uvec4 nearest_0() {
  bool is_alone = !walk.ended || rest.alone || nearest.pending >= 0;
  float label = is_alone ? -1.0 : nearest.label;
#ifdef HAS_TRANSFORMS
  return uvec4(floatBitsToUint(vec2(nearest.t_space, label)), nearest.address, walk.steps);
#else
  return uvec4(floatBitsToUint(vec2(nearest.t, label)), nearest.address, walk.steps);
#endif
}
uvec4 nearest_1() {
#ifdef HAS_TRANSFORMS
  return uvec4(floatBitsToUint(vec3(nearest.weights, nearest.t_world)), nearest.space);
#else
  return uvec4(floatBitsToUint(nearest.weights), 0u, 0u);
#endif
}
#define WRITE(K, FIRST, SECOND) TAKE_RAY(K) FIRST = nearest_0(), SECOND = nearest_1();
#endif

void main() {
  ivec2 pixel = pixel_of_pass();
#ifdef RENDERING
  int number = pixel.y * BATCH_WIDTH + pixel.x * BUNDLE_SIZE;  // the rays of a bundle stand side by side
#else
  int number = (pixel.y * BATCH_WIDTH + pixel.x) * BUNDLE_SIZE;
#endif
  int first = number;
  FOR_EACH_RAY(begin(number++))
  TAKE_RAY(0)
  start_walk();
  int octant = octant_of(ray.d);
  is_anyone_walking = false;
  FOR_EACH_RAY(settle(octant))
  walk.ended = !is_anyone_walking;
#ifdef HAS_TRANSFORMS
  bool is_walking = !walk.ended;
  while (is_walking) {
    if (is_walking) {
      walk_tree();
      change_space();
      is_walking = !walk.ended && !walk.stalled && walk.steps < pass_walk.w;
    }
  }
#else
  if (!walk.ended) walk_tree();
#endif
#ifdef BUNDLE_KINDS
  WRITE(0, out_0)
  WRITE(1, out_1)
#if BUNDLE_SIZE > 2
  WRITE(2, out_2)
#endif
#if BUNDLE_SIZE > 3
  WRITE(3, out_3)
#endif
#elif defined(BUNDLE_RESULTS) && defined(HAS_TRANSFORMS)
  WRITE(0, out_0, out_1, out_2, out_3)
  WRITE(1, out_4, out_5, out_6, out_7)
#elif defined(BUNDLE_RESULTS)
  WRITE(0, out_0, out_1, out_2)
  WRITE(1, out_3, out_4, out_5)
#else
  WRITE(0, out_0, out_1)
  WRITE(1, out_2, out_3)
#if BUNDLE_SIZE > 2
  WRITE(2, out_4, out_5)
#endif
#if BUNDLE_SIZE > 3
  WRITE(3, out_6, out_7)
#endif
#endif
}
