// SPDX-License-Identifier: MIT
// The walk through a geometry image of layout `compact`. The inner loop visits nodes alone, the outer one a leaf's
// primitives.
//
// Both loops leave their bodies before they change what they depend on: a pixel that has left computes the same values
// again while its neighbours go on, so that values read after a loop are right even where the driver overwrites them
// (Mesa 22.3).

void start_region(int start, int copy_size, int octant) {
  walk.at = ivec2(start + (octant & pass_walk.y) * copy_size, 0);
}
void start_walk() { start_region(0, pass_walk.x, octant_of(ray.d)); }

#ifdef BOUNDS_AABB
#define NODE_TEXELS 2
#else
#define NODE_TEXELS 1
#endif

#ifdef HAS_TRANSFORMS
// Goes on behind the leaf of a transform.
void go_behind(int leaf) { walk.at.x = leaf + NODE_TEXELS; }
// Whether a pass that goes on from here visits a node first: the end of a space is one.
bool stands_at_node() { return true; }
#endif

void walk_tree() {
  int at = walk.at.x;
#ifdef BOUNDS_AABB
  FOR_EACH_RAY(set_slabs())
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
      bool is_hit = is_end || box_is_met(node.xyz, more.xyz);
      leaf_is_hit = is_hit && word < 0;
#else
      float distance2 = distance2_to_segments(node.xyz);
      bool is_hit = distance2 <= abs(node.w);
      leaf_is_hit = distance2 <= -node.w;
#endif
#ifdef COUNT_VISITS
      if (walk.cluster_at != at) count_visit(at, is_hit);
#endif
#ifdef CAPTURE
      capture_node(ivec2(at, 0), is_hit, node.w, vec2(0.0), nearest.t);
#endif
      if (leaf_is_hit || walk.steps >= pass_walk.w) break;
      at += is_hit || word < 0 ? NODE_TEXELS : word & pass_walk.z;
#ifdef CAPTURE
      if (capture_is_full()) break;
#endif
    }
    bool is_end = word == END_WORD;
    bool in_cluster = leaf_is_hit && !is_end;
#ifdef HAS_TRANSFORMS
    int transform = (word & pass_walk.z) - pass_image.w;
    if (in_cluster && transform >= 0) walk.request = transform;
    in_cluster = in_cluster && transform < 0;
#endif
    int address = walk.cluster_at == at ? walk.cluster_next : word & pass_walk.z;
    bool is_last = !in_cluster;
    while (!is_last && !walk_waits() && is_primitive(address)) {
      is_last = test_primitive(address) < 0.0;
      address = next_primitive(address);
    }
    if (!is_primitive(address)) is_last = true;
#ifdef HAS_TRANSFORMS
    if (leaf_is_hit && is_end && walk.space != SPACE_WORLD) walk.request = REQUEST_LEAVE;
    if (leaf_is_hit && is_end && walk.space == SPACE_WORLD) walk.ended = true;
#else
    if (leaf_is_hit && is_end) walk.ended = true;
#endif
#ifdef ANY_HIT
    if (in_cluster && all_have_hit()) walk.ended = true;
#endif
    if (in_cluster && !is_last) {
      walk.cluster_at = at;
      walk.cluster_next = address;
      --walk.steps;  // the leaf will be visited again
    }
    if (in_cluster && is_last) at += NODE_TEXELS;
    if (walk.ended || walk_waits() || walk.steps >= pass_walk.w) break;
#ifdef HAS_TRANSFORMS
    if (walk.request != REQUEST_NONE) break;
#endif
#ifdef CAPTURE
    if (capture_is_full()) break;
#endif
  }
  walk.at.x = at;
}

#if defined(HAS_TRANSFORMS) && BUNDLE_SIZE > 1
// Whether `ray` meets the leaf that the walk has stopped at.
bool meets_leaf() {
  vec4 node = texel(walk.at.x);
#ifdef BOUNDS_AABB
  return meets_box(node.xyz, texel(walk.at.x + 1).xyz);
#else
  return distance2_to_segment(node.xyz) <= -node.w;
#endif
}
#endif
