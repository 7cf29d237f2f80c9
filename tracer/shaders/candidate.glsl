// SPDX-License-Identifier: MIT
// How a primitive becomes the nearest hit. Tree and brute force share every line of this, and the result does not depend
// on the order in which primitives come: the least t wins, among equal t the lowest primitive number.

#ifdef HAS_TRANSFORMS
// The bound on t in the space of `ray` that keeps every hit that is as near as t_world: the margin is more than the
// roundings of t * t_scale + t_shift, here and in `offer`.
float bound_of(float t_world) {
  float inverse = 1.0 / ray.t_scale;
  return (t_world - ray.t_shift) * inverse + (abs(t_world) + abs(ray.t_shift)) * inverse * 4.76837158203125e-7;
}

// Hits of all spaces are compared by the world's t, then by node (the world first), then by number, so that the answer
// does not depend on the order of the walk.
void offer(bool hit, float t, float label, int address, vec2 weights) {
  PRECISE float t_world = t * ray.t_scale + ray.t_shift;
  bool first = walk.space < nearest.space || (walk.space == nearest.space && label < nearest.label);
  if (hit && t > ray.t_low && (t_world < nearest.t_world || (t_world == nearest.t_world && first))) {
    nearest.t_world = t_world;
    nearest.t_space = t;
    nearest.space = walk.space;
    nearest.t = bound_of(t_world);
    nearest.label = label;
    nearest.address = address;
    nearest.weights = weights;
  }
}
#else
void offer(bool hit, float t, float label, int address, vec2 weights) {
  if (hit && t > ray.t_low && (t < nearest.t || (t == nearest.t && label < nearest.label))) {
    nearest.t = t;
    nearest.label = label;
    nearest.address = address;
    nearest.weights = weights;
  }
}
#endif

#ifdef CAPTURE
// Keeps a primitive's test; `before` is the nearest hit as it was until then.
void capture_primitive(uint kind, bool hit, bool pending, float t, float label, int address, vec2 weights,
                       Nearest before) {
#ifdef HAS_TRANSFORMS
  float bound = before.t_world, now = nearest.t_world;
  int space = walk.space;
  bool accepted = nearest.space != before.space;
#else
  float bound = before.t, now = nearest.t;
  int space = -1;
  bool accepted = false;
#endif
  accepted = accepted || now != bound || nearest.label != before.label;
  bool is_sphere = primitive_1(address).w == KIND_SPHERE;
  uint flags = (is_sphere ? CAPTURE_SPHERE : 0u) + (hit ? CAPTURE_HIT : 0u) + (pending ? CAPTURE_PENDING : 0u) + (accepted ? CAPTURE_ACCEPTED : 0u);
  capture_event(uvec4(kind + flags, walk.steps, address, floatBitsToUint(label)),
                uvec4(floatBitsToUint(t), floatBitsToUint(weights), floatBitsToUint(ray.t_low)),
                floatBitsToUint(is_sphere ? captured.sphere : captured.numbers), uvec3(space, floatBitsToUint(bound), floatBitsToUint(now)));
}

#endif
// Tests `ray` against a primitive, given by its texels.
void test_primitive(int address, vec4 p0, vec4 p1, vec4 p2) {
  float label = abs(p0.w);
  ++nearest.tests;
#ifdef HAS_TRIANGLES
  TriangleHit triangle = intersect_triangle(p0.xyz, p1.xyz, p2.xyz);
  bool hit = triangle.inside && !triangle.edge_on;
  bool pending = triangle.inside && triangle.edge_on;
  float t = triangle.t;
  vec2 weights = triangle.weights;
#endif
#ifdef HAS_SPHERES
  float t_sphere;
  bool hit_sphere = intersect_sphere(p0.xyz, p1.x, t_sphere);
#ifdef HAS_TRIANGLES
  bool is_sphere = p1.w == KIND_SPHERE;
  hit = is_sphere ? hit_sphere : hit;
  t = is_sphere ? t_sphere : t;
  weights = is_sphere ? vec2(0.0) : weights;
  pending = pending && !is_sphere;
#else
  bool hit = hit_sphere;
  float t = t_sphere;
  vec2 weights = vec2(0.0);
#endif
#endif
#ifdef CAPTURE
  Nearest before = nearest;
#endif
  offer(hit, t, label, address, weights);
#ifdef HAS_TRIANGLES
  if (pending) nearest.pending = address;
#endif
#ifdef CAPTURE
  capture_primitive(CAPTURE_PRIMITIVE, hit, nearest.pending == address, t, p0.w, address, weights, before);
#endif
}

// Tests the primitive at an address. Returns its label: negative on the last of a cluster.
float test_primitive(int address) {
  vec4 p0 = primitive_0(address), p1 = primitive_1(address);
#ifdef HAS_TRIANGLES
  vec4 p2 = primitive_2(address);
#else
  vec4 p2 = vec4(0.0);
#endif
  FOR_EACH_RAY(test_primitive(address, p0, p1, p2))
  return p0.w;
}

// Whether the walk has to stop for a triangle seen edge-on. A bundle goes on: the ray that meets one walks alone later.
#if BUNDLE_SIZE == 1
bool walk_waits() { return nearest.pending >= 0; }
#else
bool walk_waits() { return false; }
#endif

#ifdef ANY_HIT
// Shadow rays ask only whether there is a hit: the first one ends the walk, of a bundle the first one of its last ray.
#if BUNDLE_SIZE == 1
bool all_have_hit() { return nearest.label < NO_LABEL; }
#else
bool is_anyone_looking;
void look_for_hit() {
  if (nearest.label < NO_LABEL && rest.in_space == REST_NONE) rest_for_good(false);
  is_anyone_looking = is_anyone_looking || rest.in_space != REST_FOR_GOOD;
}
bool all_have_hit() {
  is_anyone_looking = false;
  FOR_EACH_RAY(look_for_hit())
  return !is_anyone_looking;
}
#endif
#endif

#ifdef THOROUGH
// A triangle seen edge-on costs several times an ordinary one and is rare: the walk stops at it, it is settled here,
// outside of the walking loops, and the walk goes on behind it.
void resolve_pending() {
#ifdef HAS_TRIANGLES
  int address = max(nearest.pending, 0);
  vec4 p0 = primitive_0(address);
  TriangleHit triangle = resolve_edge_on(p0.xyz, primitive_1(address).xyz, primitive_2(address).xyz);
#ifdef CAPTURE
  Nearest before = nearest;
#endif
  offer(triangle.inside && nearest.pending >= 0, triangle.t, abs(p0.w), address, triangle.weights);
#ifdef CAPTURE
  if (before.pending >= 0)
    capture_primitive(CAPTURE_EDGE_ON, triangle.inside, false, triangle.t, p0.w, address, triangle.weights, before);
#endif
#endif
  nearest.pending = -1;
}
#endif
