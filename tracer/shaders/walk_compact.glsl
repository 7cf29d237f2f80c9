// SPDX-License-Identifier: MIT
// The walk through a geometry image of layout `compact`. The inner loop visits nodes alone, the outer one a leaf's
// primitives.
//
// Both loops leave their bodies before they change what they depend on: a pixel that has left computes the same values
// again while its neighbours go on, so that values read after a loop are right even where the driver overwrites them
// (Mesa 22.3).

void start_walk() {
  int octant = (ray.d.x < 0.0 ? 1 : 0) + (ray.d.y < 0.0 ? 2 : 0) + (ray.d.z < 0.0 ? 4 : 0);
  walk.at = ivec2((octant & pass_walk.y) * pass_walk.x, 0);
}

#ifdef BOUNDS_AABB
#define NODE_TEXELS 2
#else
#define NODE_TEXELS 1
#endif

void walk_tree() {
  int at = walk.at.x;
#ifdef BOUNDS_AABB
  vec3 inverse = slab_inverse(ray.d);
#endif
  for (;;) {
    int word = 0;
    bool leaf_is_hit = false;
    for (;;) {
      vec4 node = texel(at);
      ++walk.steps;
      word = floatBitsToInt(node.w);
#ifdef BOUNDS_AABB
      vec4 more = texel(at + 1);
      bool is_end = word == END_WORD;
      bool is_hit = is_end || meets_box(node.xyz, more.xyz, inverse);
      leaf_is_hit = is_hit && word < 0;
#else
      float distance2 = distance2_to_segment(node.xyz);
      bool is_hit = distance2 <= abs(node.w);
      leaf_is_hit = distance2 <= -node.w;
#endif
      if (leaf_is_hit || walk.steps >= pass_walk.w) break;
      at += is_hit || word < 0 ? NODE_TEXELS : word & pass_walk.z;
    }
    bool is_end = word == END_WORD;
    bool in_cluster = leaf_is_hit && !is_end;
    int address = walk.cluster_at == at ? walk.cluster_next : word & pass_walk.z;
    bool is_last = !in_cluster;
    while (!is_last && nearest.pending < 0 && is_primitive(address)) {
      is_last = test_primitive(address) < 0.0;
      address = next_primitive(address);
    }
    if (!is_primitive(address)) is_last = true;
    if (leaf_is_hit && is_end) walk.ended = true;
    if (in_cluster && !is_last) {
      walk.cluster_at = at;
      walk.cluster_next = address;
      --walk.steps;  // the leaf will be visited again
    }
    if (in_cluster && is_last) at += NODE_TEXELS;
    if (walk.ended || nearest.pending >= 0 || walk.steps >= pass_walk.w) break;
  }
  walk.at.x = at;
}
