// SPDX-License-Identifier: MIT
// The walk's way in and out of transforms.

// Of the ray as derive_ray gives it: the copy that is walked.
int derived_octant;

#ifdef OUT_INVERSE
// With rays that come out by the inverse, only origin and direction drift. Everything that a decision hangs on which
// must be the same on the way in and on the way out (the copy that is walked, the scale of t, whether the origin was
// moved) is derived as for rays that are restored. Where the origin was moved, so is the ray.
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

// Takes `ray` into the space of a node. False where this program can't: its origin is too far away, or the driver has
// ended a loop.
bool enter(int node) {
#ifdef OUT_INVERSE
  enter_drifted(node);
#else
  enter_space(node);
  derived_octant = octant_of(ray.d);
#endif
  bool is_late = ray.cut;
#ifndef THOROUGH
  is_late = is_late || (ray.too_far && !ray.misses);
#endif
  return !is_late;
}

// Takes `ray` out of it again.
void leave(int node, int outer) {
#ifdef OUT_INVERSE
  vec4 row_0 = record_texel(node, 3), row_1 = record_texel(node, 4), row_2 = record_texel(node, 5);
  vec3 translation = vec3(record_texel(node, 0).w, record_texel(node, 1).w, record_texel(node, 2).w);
  PRECISE vec3 o = times(row_0, row_1, row_2, entered_o) + translation;
  PRECISE vec3 d = times(row_0, row_1, row_2, entered_d);
#endif
  derive_ray(outer);
  derived_octant = octant_of(ray.d);
#ifdef OUT_INVERSE
  if (outer == SPACE_WORLD || ray.shift_unit == 1.0) {
    ray.o = o;
    set_direction(d);
    entered_o = o;
    entered_d = scale_exactly(d, -ray.exponent);
  }
#endif
}

// The walk goes on in the space of a node, in the copy for an octant, and behind the leaf of a node again.
void start_space(int node, int octant) {
  ++walk.transforms;
  walk.cluster_at = -1;  // the same cluster may have been left before its end in another instance
  walk.space = node;
  start_region(int(record_texel(node, 4).w), int(record_texel(node, 5).w), octant);
}
void go_on_outside(int node, int outer, int octant) {
  int copy = octant & pass_walk.y;
  vec4 places = record_texel(node, 8 + (copy >> 2));
  go_behind(int(places[copy & 3]));
  walk.space = outer;
}

#if BUNDLE_SIZE == 1
// Carries out what the walk asks for at a transform, and at the end of a space.
void change_space() {
  int node = walk.request;
  bool enters = node >= 0;
  bool leaves = node == REQUEST_LEAVE;
  walk.request = REQUEST_NONE;
  Walk before = walk;
  if (enters) {
    bool is_late = !enter(node);
    walk.stalled = is_late;
    if (is_late) --walk.steps;  // the leaf will be visited again
    if (!is_late) {
      start_space(node, derived_octant);
      leaves = ray.misses;  // of what stands there: out again
#ifdef CAPTURE
      captured.octant = derived_octant;
      capture_ray(CAPTURE_ENTER, node, ray.misses, bound_of(nearest.t_world));
#endif
    }
  }
  if (leaves) {
    node = walk.space;
    int outer = int(record_texel(node, 3).w) - 1;
    leave(node, outer);
    // Without the ray there is no telling which copy to go on in: another pass comes here again, and counts this node.
    if (ray.cut) walk = before;
    if (ray.cut && stands_at_node()) --walk.steps;
    if (!ray.cut) go_on_outside(node, outer, derived_octant);
    walk.stalled = ray.cut;
#ifdef CAPTURE
    captured.octant = derived_octant & pass_walk.y;
#endif
  }
  if (enters || leaves) nearest.t = bound_of(nearest.t_world);
#ifdef CAPTURE
  if (leaves) capture_ray(CAPTURE_LEAVE, node, false, nearest.t);
#endif
}
#endif
