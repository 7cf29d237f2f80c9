// SPDX-License-Identifier: MIT
// The walk's way in and out of transforms.

#ifdef OUT_INVERSE
// With rays that come out by the inverse, only origin and direction drift. Everything that a decision hangs on which
// must be the same on the way in and on the way out (the copy that is walked, the scale of t, whether the origin was
// moved) is derived as for rays that are restored. Where the origin was moved, so is the ray.
int derived_octant;

void enter_drifted(int node) {
  vec4 row_0 = record_texel(node, 0), row_1 = record_texel(node, 1), row_2 = record_texel(node, 2);
  PRECISE vec3 o = times(row_0, row_1, row_2, ray.o - vec3(row_0.w, row_1.w, row_2.w));
  PRECISE vec3 d = times(row_0, row_1, row_2, ray.d);
  derive_ray(node);
  derived_octant = octant_of(ray.d);
  entered_o = o;
  entered_d = d;
  if (ray.shift_unit == 1.0) {
    ray.o = o;
    set_direction(scale_exactly(d, ray.exponent));
  }
}
#endif

// Carries out what the walk asks for at a transform, and at the end of a space.
void change_space() {
  int node = walk.request;
  bool enters = node >= 0;
  bool leaves = node == REQUEST_LEAVE;
  walk.request = REQUEST_NONE;
  if (enters) {
#ifdef OUT_INVERSE
    enter_drifted(node);
#else
    enter_space(node);
#endif
    bool is_late = ray.cut;
#ifndef THOROUGH
    is_late = is_late || (ray.too_far && !ray.misses);
#endif
    walk.stalled = is_late;
    if (is_late) --walk.steps;  // the leaf will be visited again
    if (!is_late) {
      ++walk.transforms;
      walk.cluster_at = -1;  // the same cluster may have been left before its end in another instance
      walk.space = node;
#ifdef OUT_INVERSE
      start_region(int(record_texel(node, 4).w), int(record_texel(node, 5).w), derived_octant);
#else
      start_region(int(record_texel(node, 4).w), int(record_texel(node, 5).w), octant_of(ray.d));
#endif
      leaves = ray.misses;  // of what stands there: out again
#ifdef CAPTURE
#ifdef OUT_INVERSE
      captured.octant = derived_octant;
#else
      captured.octant = octant_of(ray.d);
#endif
      capture_ray(CAPTURE_ENTER, node, ray.misses, bound_of(nearest.t_world));
#endif
    }
  }
  if (leaves) {
    node = walk.space;
    int outer = int(record_texel(node, 3).w) - 1;
#ifdef OUT_INVERSE
    vec4 row_0 = record_texel(node, 3), row_1 = record_texel(node, 4), row_2 = record_texel(node, 5);
    vec3 translation = vec3(record_texel(node, 0).w, record_texel(node, 1).w, record_texel(node, 2).w);
    PRECISE vec3 o = times(row_0, row_1, row_2, entered_o) + translation;
    PRECISE vec3 d = times(row_0, row_1, row_2, entered_d);
#endif
    derive_ray(outer);
    int copy = octant_of(ray.d) & pass_walk.y;
#ifdef CAPTURE
    captured.octant = copy;
#endif
    vec4 places = record_texel(node, 8 + (copy >> 2));
    go_behind(int(places[copy & 3]));
    walk.space = outer;
    walk.stalled = ray.cut;
#ifdef OUT_INVERSE
    if (outer == SPACE_WORLD || ray.shift_unit == 1.0) {
      ray.o = o;
      set_direction(d);
      entered_o = o;
      entered_d = scale_exactly(d, -ray.exponent);
    }
#endif
  }
  if (enters || leaves) nearest.t = bound_of(nearest.t_world);
#ifdef CAPTURE
  if (leaves) capture_ray(CAPTURE_LEAVE, node, false, nearest.t);
#endif
}
