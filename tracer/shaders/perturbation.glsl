// SPDX-License-Identifier: MIT
// From three random numbers to perturbations (SEMANTICS 7.4).

vec3 in_cube(vec3 u) { return 2.0 * u - 1.0; }
#ifdef MODEL_PHYSICAL
vec3 in_lens(vec3 u) { return vec3(sqrt(u.x) * cos_sin_turns(u.y), 0.0); }
vec3 in_ball(vec3 u) {
  float s = 2.0 * sqrt(u.x * (1.0 - u.x));
  return cube_root(u.z) * vec3(s * cos_sin_turns(u.y), 1.0 - 2.0 * u.x);
}
#else
vec3 in_lens(vec3 u) { return in_cube(u); }
vec3 in_ball(vec3 u) { return in_cube(u); }
#endif
