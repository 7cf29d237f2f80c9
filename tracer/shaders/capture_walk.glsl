// SPDX-License-Identifier: MIT
// The events of a captured walk that need its state, and what a capturing pass writes beside the production's results.

layout(location = 4) out uvec4 out_4;
layout(location = 5) out uvec4 out_5;
layout(location = 6) out uvec4 out_6;
layout(location = 7) out uvec4 out_7;  // ...; in w events of the pass, flags in bits 31 (it ended only because it was full) and 30

#ifdef HAS_TRANSFORMS
int space_at_hand() { return walk.space; }
float nearest_of_world() { return nearest.t_world; }
#else
int space_at_hand() { return -1; }
float nearest_of_world() { return nearest.t; }
#endif

void capture_node(ivec2 at, bool hit, float w, vec2 link, float bound) {
  capture_event(uvec4(CAPTURE_NODE + (hit ? CAPTURE_HIT : 0u), walk.steps, at), floatBitsToUint(captured.numbers),
                uvec4(floatBitsToUint(bound), floatBitsToUint(link), floatBitsToUint(w)),
                uvec3(space_at_hand(), floatBitsToUint(nearest_of_world()), 0u));
}

// The ray as it walks from here on: at the start, in or out of the space of a node.
void capture_ray(uint kind, int node, bool misses, float bound) {
#ifdef HAS_TRANSFORMS
  float t_scale = ray.t_scale, t_shift = ray.t_shift;
#else
  float t_scale = 1.0, t_shift = 0.0;
#endif
  capture_event(uvec4(kind + (misses ? CAPTURE_MISSES : 0u), walk.steps, node, space_at_hand()),
                floatBitsToUint(vec4(ray.o, t_scale)), floatBitsToUint(vec4(ray.d, t_shift)),
                uvec3(floatBitsToUint(bound), floatBitsToUint(ray.t_low), captured.octant & pass_walk.y));
}

// Of the pass: the event, or the ray by which another pass goes on.
void write_captured(bool unfinished) {
  captured.full = unfinished && capture_is_full() && nearest.pending < 0;
#ifdef HAS_TRANSFORMS
  captured.full = captured.full && !walk.stalled && !world_ray.too_far;
#ifdef OUT_INVERSE
  if (captured.wanted >= captured.count) {
    captured.a = floatBitsToUint(vec4(ray.o, 0.0));
    captured.b = floatBitsToUint(vec4(ray.d, 0.0));
    captured.c = floatBitsToUint(vec4(entered_o, 0.0));
    captured.d = floatBitsToUint(entered_d);
  }
#endif
#else
  captured.full = captured.full && !ray.too_far;
#endif
  out_4 = captured.a;
  out_5 = captured.b;
  out_6 = captured.c;
  out_7 = uvec4(captured.d, uint(captured.count) + (captured.full ? 0x80000000u : 0u));
#ifdef HAS_TRANSFORMS
  // The bound is the nearest t itself until the space changes or something is hit; then it is bound_of.
  if (floatBitsToUint(nearest.t) == floatBitsToUint(nearest.t_world)) out_7.w += 0x40000000u;
#endif
}

#ifdef HAS_TRANSFORMS
// The inverse of write_captured, in four texels of the state, after derive_ray: what drifts is as it was.
void restore_walk(usampler2D state, ivec2 at) {
#ifdef OUT_INVERSE
  ray.o = uintBitsToFloat(texelFetch(state, at, 0).xyz);
  set_direction(uintBitsToFloat(texelFetch(state, at + ivec2(1, 0), 0).xyz));
  entered_o = uintBitsToFloat(texelFetch(state, at + ivec2(2, 0), 0).xyz);
  entered_d = uintBitsToFloat(texelFetch(state, at + ivec2(3, 0), 0).xyz);
#endif
  bool as_started = (texelFetch(state, at + ivec2(3, 0), 0).w & 0x40000000u) != 0u;
  nearest.t = as_started ? nearest.t_world : bound_of(nearest.t_world);
}
#endif
