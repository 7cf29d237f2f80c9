// SPDX-License-Identifier: MIT
// A bundle's way in and out of transforms. A ray that does not meet a transform's leaf rests while the others are inside
// and comes back as it was: a ray that comes out by the inverse has drifted, so it must go in where it would alone, and
// nowhere else.

// Of the first ray, whether it rests or not: the copy that the bundle walks in a space must be known again on the way out.
// Where the driver has ended a loop it is not: then the bundle walks no further, and each of its rays alone.
int octant_of_bundle(int space) {
  TAKE_RAY(0)
  derive_ray(space);
  walk.stalled = walk.stalled || ray.cut;
  return octant_of(ray.d);
}

// Rays that drift answer by the way they went: those that would walk another copy do so alone.
bool walks_elsewhere(int octant, int octant_of_others) {
#ifdef OUT_INVERSE
  return ((octant ^ octant_of_others) & pass_walk.y) != 0;
#else
  return false;
#endif
}

bool is_anyone_inside;

void enter_or_rest(int node, int octant) {
  bool is_here = rest.in_space == REST_NONE;
  bool enters = is_here && meets_leaf();
  if (is_here && !enters) {
    rest.in_space = node;
    rest.o = ray.o, rest.d = ray.d, rest.dn = ray.dn;
    rest.t_low = ray.t_low, rest.t = nearest.t;
    put_out_of_reach();
  }
  if (enters) {
    bool is_late = !enter(node);
    nearest.t = bound_of(nearest.t_world);
    if (ray.misses) put_out_of_reach();
    if (is_late || walks_elsewhere(derived_octant, octant))
      rest_for_good(true);
    else if (!ray.misses)
      is_anyone_inside = true;
  }
}

void leave_or_wake(int node, int outer) {
  if (rest.in_space == REST_NONE) {
    leave(node, outer);
    nearest.t = bound_of(nearest.t_world);
    if (ray.cut) rest_for_good(true);
  }
  if (rest.in_space == node) {
    rest.in_space = REST_NONE;
    ray.o = rest.o, ray.d = rest.d, ray.dn = rest.dn;
    ray.t_low = rest.t_low, nearest.t = rest.t;
  }
}

// Carries out what the walk asks for at a transform, and at the end of a space.
void change_space() {
  int node = walk.request;
  bool enters = node >= 0;
  bool leaves = node == REQUEST_LEAVE;
  walk.request = REQUEST_NONE;
  if (enters) {
    int octant = octant_of_bundle(node);
    is_anyone_inside = false;
    FOR_EACH_RAY(enter_or_rest(node, octant))
    start_space(node, octant);
    leaves = !is_anyone_inside;
  }
  if (leaves) {
    node = walk.space;
    int outer = int(record_texel(node, 3).w) - 1;
    FOR_EACH_RAY(leave_or_wake(node, outer))
    go_on_outside(node, outer, octant_of_bundle(outer));
  }
}
