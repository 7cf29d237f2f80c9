// SPDX-License-Identifier: MIT
// The paper's parallel traversal: the rays of a bundle walk the tree together (section 5). They share `walk`, and so
// every fetch of a node or primitive and all arithmetic on links; `ray` and `nearest` are, in turn, those of each ray.
// A node is entered if any of them meets it.
//
// What a ray answers does not depend on its walk, so its answer is the one that it has alone. A ray that needs rare
// code is left alone: another pass traces it anew.

#if BUNDLE_SIZE == 1
#define FOR_EACH_RAY(DO) DO;
#else

// What a ray keeps while the others go where it does not.
struct Rest {
  int in_space;  // the node that the others have entered without it; REST_NONE; REST_FOR_GOOD
  bool alone;    // another pass must trace this ray
#ifdef HAS_TRANSFORMS
  vec3 o, d, dn;  // of its ray ...
  float t_low;
  float t;        // ... and the bound on its walk
#endif
};
const int REST_NONE = -1;
const int REST_FOR_GOOD = 0x7fffffff;
const float OUT_OF_REACH = 1.0e30;  // its square is infinite

Rest rest;
PRECISE WalkRay bundle_ray[BUNDLE_SIZE];
PRECISE Nearest bundle_nearest[BUNDLE_SIZE];
Rest bundle_rest[BUNDLE_SIZE];
#ifdef HAS_TRANSFORMS
PRECISE WalkRay bundle_world_ray[BUNDLE_SIZE];
#endif
#ifdef OUT_INVERSE
PRECISE vec3 bundle_entered_o[BUNDLE_SIZE], bundle_entered_d[BUNDLE_SIZE];
#endif

// Makes ray K the one at hand, and keeps what becomes of it. K is a number, never a variable: indices that the compiler
// knows turn all of this copying into nothing.
#ifdef HAS_TRANSFORMS
#define TAKE_WORLD_RAY(K) world_ray = bundle_world_ray[K];
#define KEEP_WORLD_RAY(K) bundle_world_ray[K] = world_ray;
#else
#define TAKE_WORLD_RAY(K)
#define KEEP_WORLD_RAY(K)
#endif
#ifdef OUT_INVERSE
#define TAKE_ENTERED(K) entered_o = bundle_entered_o[K], entered_d = bundle_entered_d[K];
#define KEEP_ENTERED(K) bundle_entered_o[K] = entered_o, bundle_entered_d[K] = entered_d;
#else
#define TAKE_ENTERED(K)
#define KEEP_ENTERED(K)
#endif
// On one line each: GLSL 3.30 knows no continuation.
#define TAKE_RAY(K) ray = bundle_ray[K], nearest = bundle_nearest[K], rest = bundle_rest[K]; TAKE_WORLD_RAY(K) TAKE_ENTERED(K)
#define KEEP_RAY(K) bundle_ray[K] = ray, bundle_nearest[K] = nearest, bundle_rest[K] = rest; KEEP_WORLD_RAY(K) KEEP_ENTERED(K)
#define FOR_RAY(K, DO) TAKE_RAY(K) DO; KEEP_RAY(K)

#if BUNDLE_SIZE == 2
#define FOR_EACH_RAY(DO) FOR_RAY(0, DO) FOR_RAY(1, DO)
#elif BUNDLE_SIZE == 3
#define FOR_EACH_RAY(DO) FOR_RAY(0, DO) FOR_RAY(1, DO) FOR_RAY(2, DO)
#else
#define FOR_EACH_RAY(DO) FOR_RAY(0, DO) FOR_RAY(1, DO) FOR_RAY(2, DO) FOR_RAY(3, DO)
#endif

// Takes the ray at hand where it meets nothing but the end of a space.
void put_out_of_reach() {
  ray.o = vec3(OUT_OF_REACH);
  ray.d = vec3(0.0, 0.0, 1.0);
  ray.dn = ray.d;
  ray.t_low = OUT_OF_REACH;
}
void rest_for_good(bool alone) {
  rest.in_space = REST_FOR_GOOD;
  rest.alone = rest.alone || alone;
  put_out_of_reach();
}
#endif
