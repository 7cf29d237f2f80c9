// SPDX-License-Identifier: MIT
// The walk through a geometry image of layout `paper`: the paper's FINDNEXTINTERSECTION (section 4). The inner loop
// visits nodes alone and ends at a link below 0, the outer one processes what that link leads to and goes on at the out
// link of the node that led there.
//
// As in walk_compact.glsl, a pixel that has left a loop computes the same values again while its neighbours go on.

// Where a link leads, without the integer that tells the kind of what stands there.
vec2 link_place(vec2 link) { return vec2(link.x - floor(link.x), link.y); }
int link_cell(vec2 link) {
  ivec2 place = ivec2(floor(link_place(link) / pass_factor.yz));
  return ((place.y >> 1) << pass_image.y) + place.x;
}
vec2 cell_link(int cell) {
  return (vec2(ivec2(cell & pass_image.x, (cell >> pass_image.y) * 2)) + 0.5) * pass_factor.yz;
}

void start_region(int start, int copy_size, int octant) {
  walk.at = floatBitsToInt(cell_link(start + (octant & pass_walk.y) * copy_size));
}
void start_walk() { start_region(0, pass_walk.x, octant_of(ray.d)); }

#ifdef HAS_TRANSFORMS
// Goes on behind the leaf of a transform.
void go_behind(int leaf) { walk.at = floatBitsToInt(cell_texel(leaf, 1).zw); }
// Whether a pass that goes on from here visits a node first, and is not at a link to the end of a space.
bool stands_at_node() { return intBitsToFloat(walk.at.x) >= 0.0; }
#endif

// A chain has led to the end of the space at hand.
void end_region() {
#ifdef HAS_TRANSFORMS
  if (walk.space != SPACE_WORLD) walk.request = REQUEST_LEAVE;
  if (walk.space == SPACE_WORLD) walk.ended = true;
#else
  walk.ended = true;
#endif
}

void walk_tree() {
  vec2 at = intBitsToFloat(walk.at);
  if (at.x < 0.0) end_region();  // nothing is left behind the last primitive, which was seen edge-on, or transform
#ifdef BOUNDS_AABB
  FOR_EACH_RAY(set_slabs())
#endif
  for (;;) {
    if (walk.ended) break;
#ifdef HAS_TRANSFORMS
    if (walk.request != REQUEST_NONE) break;
#endif
    vec4 links = vec4(0.0);
    vec2 geometry = vec2(0.0);
    for (;;) {
      vec4 node = textureLod(u_geometry, at, 0.0);
      links = textureLod(u_geometry, at + vec2(0.0, pass_factor.z), 0.0);
      ++walk.steps;
#ifdef BOUNDS_AABB
      bool is_hit = box_is_met(node.xyz, textureLod(u_geometry, at + vec2(pass_factor.y, 0.0), 0.0).xyz);
#else
      bool is_hit = distance2_to_segments(node.xyz) <= node.w;
#endif
      geometry = is_hit ? links.xy : links.zw;
#ifdef COUNT_VISITS
      if (walk.cluster_at != link_cell(at)) count_visit(link_cell(at), is_hit);
#endif
#ifdef CAPTURE
      capture_node(floatBitsToInt(at), is_hit, node.w, geometry, nearest.t);
#endif
      if (geometry.x < 0.0 || walk.steps >= pass_walk.w) break;
      at = geometry;
#ifdef CAPTURE
      if (capture_is_full()) break;
#endif
    }
    // Processing geometry.
    bool in_cluster = geometry.x < 0.0 && geometry.x >= float(LINK_SPHERE);
    int cell = link_cell(at);
    int address = walk.cluster_at == cell ? walk.cluster_next : (link_cell(geometry) - pass_image.z) / PRIMITIVE_STRIDE;
    bool is_last = !in_cluster;
    while (!is_last && !walk_waits() && is_primitive(address)) {
      is_last = test_primitive(address) < 0.0;
      address = next_primitive(address);
    }
    if (!is_primitive(address)) is_last = true;
#ifdef HAS_TRANSFORMS
    bool at_transform = geometry.x < float(LINK_SPHERE) && geometry.x >= float(LINK_TRANSFORM);
    if (at_transform) walk.request = (link_cell(geometry) - pass_transforms.x) / (TRANSFORM_TEXELS / 2);
#endif
    if (geometry.x < float(LINK_TRANSFORM)) end_region();
#ifdef ANY_HIT
    if (in_cluster && all_have_hit()) walk.ended = true;
#endif
    if (in_cluster && !is_last) {
      walk.cluster_at = cell;
      walk.cluster_next = address;
      --walk.steps;  // the leaf will be visited again
    }
    if (in_cluster && is_last) {
      at = links.zw;
      // A triangle that waits is resolved in this space before it is left.
      if (at.x < 0.0 && !walk_waits()) end_region();
    }
    if (walk.ended || walk_waits() || walk.steps >= pass_walk.w) break;
#ifdef CAPTURE
    if (capture_is_full()) break;
#endif
  }
  walk.at = floatBitsToInt(at);
}

#if defined(HAS_TRANSFORMS) && BUNDLE_SIZE > 1
// Whether `ray` meets the leaf that the walk has stopped at.
bool meets_leaf() {
  vec2 at = intBitsToFloat(walk.at);
  vec4 node = textureLod(u_geometry, at, 0.0);
#ifdef BOUNDS_AABB
  return meets_box(node.xyz, textureLod(u_geometry, at + vec2(pass_factor.y, 0.0), 0.0).xyz);
#else
  return distance2_to_segment(node.xyz) <= node.w;
#endif
}
#endif
