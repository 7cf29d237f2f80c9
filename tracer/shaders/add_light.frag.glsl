// SPDX-License-Identifier: MIT
// Adds what a light brings to the sample's colour, where its shadow ray has met nothing.

uniform sampler2D u_brought, u_sum;

// w is above 0 where a walk of the sample found no end.
layout(location = 0) out vec4 out_0;

void main() {
  uint kind = texelFetch(u_hit_0, item(), 0).x & 7u;
  bool is_shadowed = kind == KIND_HIT || meet_ground(given_ray(u_ray_origins, u_ray_directions)) > 0.0;
  bool is_wrong = kind != KIND_MISS && kind != KIND_HIT && kind != KIND_UNDEFINED;
  vec4 brought = texelFetch(u_brought, item(), 0);
  vec4 sum = texelFetch(u_sum, item(), 0);
  out_0 = vec4(is_shadowed ? sum.xyz : sum.xyz + brought.xyz, sum.w + brought.w + (is_wrong ? 1.0 : 0.0));
}
