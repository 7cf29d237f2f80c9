// SPDX-License-Identifier: MIT
// The node tests: does the ray's segment 0 <= t <= best come near a bounding volume? Never "no" where a primitive
// inside is hit (bake.h).

#ifdef BOUNDS_AABB
// The slabs of a box. A direction component of 0 counts as 2^-60: over the scene's size that is far less than the
// padding.
vec3 slab_inverse(vec3 d) {
  vec3 size = max(abs(d), vec3(8.673617379884035e-19));
  return vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0) / size;
}
void set_slabs() { ray.slabs = slab_inverse(ray.d); }
bool meets_box(vec3 lower, vec3 upper) {
  vec3 t0 = (lower - ray.o) * ray.slabs, t1 = (upper - ray.o) * ray.slabs;
  vec3 enter = min(t0, t1), leave = max(t0, t1);
#ifdef CAPTURE
  capture_slabs(enter, leave);
#endif
  return max(max(enter.x, enter.y), max(enter.z, 0.0)) <= min(min(leave.x, leave.y), min(leave.z, nearest.t));
}

// Whether any ray of the bundle meets it.
bool box_is_met(vec3 lower, vec3 upper) {
  bool is_met = false;
  FOR_EACH_RAY(is_met = meets_box(lower, upper) || is_met)
  return is_met;
}
#else
// The squared distance from a sphere's centre to the segment, without square root or cases.
float distance2_to_segment(vec3 center) {
  vec3 m = center - ray.o;
  vec3 f = m - clamp(dot(m, ray.dn), 0.0, nearest.t) * ray.d;
#ifdef CAPTURE
  capture_sphere(m, f);
#endif
  return dot(f, f);
}

// The least of the bundle.
float distance2_to_segments(vec3 center) {
#if BUNDLE_SIZE == 1
  return distance2_to_segment(center);
#else
  float least = OUT_OF_REACH;
  FOR_EACH_RAY(least = min(least, distance2_to_segment(center)))
  return least;
#endif
}
#endif
