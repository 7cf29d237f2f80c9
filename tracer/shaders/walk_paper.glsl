// SPDX-License-Identifier: MIT
// The walk through a geometry image of layout `paper`: the paper's FINDNEXTINTERSECTION (section 4). The inner loop visits nodes alone and
// ends at a link below 0, the outer one processes what that link leads to and goes on at the out link of the node that led there.
//
// As in walk_compact.glsl, a pixel that has left a loop computes the same values again while its neighbours go on.

uniform int u_copy_size;     // cells of one copy of the tree
uniform int u_octant_bits;   // 7 where there is a copy per octant of directions, else 0

// Where a link leads, without the integer that tells the kind of what stands there.
vec2 link_place(vec2 link) { return vec2(link.x - floor(link.x), link.y); }
int link_cell(vec2 link) {
  ivec2 place = ivec2(floor(link_place(link) / vec2(u_texel_width, u_texel_height)));
  return ((place.y >> 1) << u_width_shift) + place.x;
}
vec2 cell_link(int cell) {
  return (vec2(ivec2(cell & u_width_mask, (cell >> u_width_shift) * 2)) + 0.5) * vec2(u_texel_width, u_texel_height);
}

void start_walk() {
  int octant = (ray.d.x < 0.0 ? 1 : 0) + (ray.d.y < 0.0 ? 2 : 0) + (ray.d.z < 0.0 ? 4 : 0);
  walk.at = floatBitsToInt(cell_link((octant & u_octant_bits) * u_copy_size));
}

void walk_tree() {
  vec2 at = intBitsToFloat(walk.at);
#ifdef BOUNDS_AABB
  vec3 inverse = slab_inverse(ray.d);
#endif
  for (;;) {
    vec4 links = vec4(0.0);
    vec2 geometry = vec2(0.0);
    for (;;) {
      vec4 node = textureLod(u_geometry, at, 0.0);
      links = textureLod(u_geometry, at + vec2(0.0, u_texel_height), 0.0);
      ++walk.steps;
#ifdef BOUNDS_AABB
      bool is_hit = meets_box(node.xyz, textureLod(u_geometry, at + vec2(u_texel_width, 0.0), 0.0).xyz, inverse);
#else
      bool is_hit = distance2_to_segment(node.xyz) <= node.w;
#endif
      geometry = is_hit ? links.xy : links.zw;
      if (geometry.x < 0.0 || walk.steps >= u_step_limit) break;
      at = geometry;
    }
    // Processing geometry.
    bool in_cluster = geometry.x < 0.0 && geometry.x >= float(LINK_SPHERE);
    int cell = link_cell(at);
    int address = walk.cluster_at == cell ? walk.cluster_next : (link_cell(geometry) - u_primitive_start) / PRIMITIVE_STRIDE;
    bool is_last = !in_cluster;
    while (!is_last && nearest.pending < 0 && is_primitive(address)) {
      is_last = test_primitive(address) < 0.0;
      address = next_primitive(address);
    }
    if (!is_primitive(address)) is_last = true;
    if (geometry.x < float(LINK_SPHERE)) walk.ended = true;
    if (in_cluster && !is_last) {
      walk.cluster_at = cell;
      walk.cluster_next = address;
      --walk.steps;  // the leaf will be visited again
    }
    if (in_cluster && is_last) {
      at = links.zw;
      if (at.x < 0.0) walk.ended = true;
    }
    if (walk.ended || nearest.pending >= 0 || walk.steps >= u_step_limit) break;
  }
  walk.at = floatBitsToInt(at);
}
