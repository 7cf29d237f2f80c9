// SPDX-License-Identifier: MIT
// The events of a captured walk that need its state, and what a capturing pass writes beside the production's results.

layout(location = 4) out uvec4 out_4;
layout(location = 5) out uvec4 out_5;
layout(location = 6) out uvec4 out_6;
layout(location = 7) out uvec4 out_7;  // ...; in w events of the pass + 2^31 where it ended only because it was full

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
                uvec3(floatBitsToUint(bound), floatBitsToUint(ray.t_low), 0u));
}

// Of the pass: the event, or the ray by which another pass goes on.
void write_captured(bool unfinished) {
  bool full = unfinished && capture_is_full() && nearest.pending < 0;
#ifdef HAS_TRANSFORMS
  full = full && !walk.stalled;
  if (captured.wanted >= captured.count) {
    captured.a = floatBitsToUint(vec4(ray.o, ray.t_scale));
    captured.b = floatBitsToUint(vec4(ray.d, ray.t_shift));
    captured.c = uvec4(0u, 0u, 0u, floatBitsToUint(ray.t_low));
#ifdef OUT_INVERSE
    captured.c.xyz = floatBitsToUint(entered_o);
    captured.d = floatBitsToUint(entered_d);
#endif
  }
#endif
  out_4 = captured.a;
  out_5 = captured.b;
  out_6 = captured.c;
  out_7 = uvec4(captured.d, uint(captured.count) + (full ? 0x80000000u : 0u));
}

#ifdef HAS_TRANSFORMS
// The inverse of write_captured, in four texels of the state.
void restore_ray(usampler2D state, ivec2 at) {
  vec4 a = uintBitsToFloat(texelFetch(state, at, 0)), b = uintBitsToFloat(texelFetch(state, at + ivec2(1, 0), 0));
  vec4 c = uintBitsToFloat(texelFetch(state, at + ivec2(2, 0), 0));
  ray.o = a.xyz;
  ray.t_scale = a.w;
  set_direction(b.xyz);
  ray.t_shift = b.w;
  ray.t_low = c.w;
  ray.cut = false;
  ray.too_far = false;
#ifdef OUT_INVERSE
  entered_o = c.xyz;
  entered_d = uintBitsToFloat(texelFetch(state, at + ivec2(3, 0), 0).xyz);
#endif
}
#endif
