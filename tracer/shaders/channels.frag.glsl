// SPDX-License-Identifier: MIT
// What a picture tells of its pixels beside colours (SEMANTICS 6.9), of one sharp ray each.

layout(location = 0) out vec4 out_0;  // N, zero for none; t, infinite for none
layout(location = 1) out vec4 out_1;  // primitive, instance (-1 for none), steps of the walk

void main() {
  Surface s = surface_at_item();
  uvec4 hit_0 = texelFetch(u_hit_0, item(), 0);
  float t = uintBitsToFloat(hit_0.y);
  float t_ground = meet_ground(s.from);
  bool on_ground = s.is_hit && t_ground > 0.0 && ((hit_0.x & 7u) != KIND_HIT || t_ground < t);
#ifdef HAS_TRANSFORMS
  float instance = float(texelFetch(u_hit_3, item(), 0).x) - 1.0;
#else
  float instance = -1.0;
#endif
  out_0 = s.is_hit ? vec4(s.outside, on_ground ? t_ground : t) : vec4(vec3(0.0), INFINITE);
  out_1 = vec4(!s.is_hit ? -1.0 : on_ground ? float(PRIMITIVE_COUNT) : float(hit_0.x >> 3), s.is_hit && !on_ground ? instance : -1.0, float(hit_0.z), 0.0);
}
