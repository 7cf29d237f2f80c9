// SPDX-License-Identifier: MIT
// A loop over all primitives, of the world and then of every instance, in place of the walk: what the tree lost, this
// finds. It shares all of the arithmetic on primitives and on rays.

#ifdef HAS_TRANSFORMS
// walk.at: the next primitive of the space at hand, and where its primitives end.
void start_walk() { walk.at = ivec2(0, pass_transforms.z); }

void walk_tree() {
  int address = walk.at.x;
  while (address < walk.at.y && nearest.pending < 0 && nearest.tests < pass_range.z) {
    test_primitive(address);
    address = next_primitive(address);
  }
  walk.at.x = address;
}

// From one instance to the next.
void change_space() {
  bool is_done = nearest.pending < 0 && walk.at.x >= walk.at.y;
  int node = walk.space + 1;
  if (is_done && node >= pass_transforms.y) walk.ended = true;
  if (is_done && node < pass_transforms.y) {
    derive_ray(node);
    bool is_late = ray.cut;
#ifndef THOROUGH
    is_late = is_late || (ray.too_far && !ray.misses);
#endif
    walk.stalled = is_late;
    if (!is_late) {
      vec4 primitives = record_texel(node, 7);
      walk.space = node;
      walk.at = ivec2(int(primitives.x), int(primitives.x) + (ray.misses ? 0 : int(primitives.y)));
      nearest.t = bound_of(nearest.t_world);
      ++walk.transforms;
    }
  }
  if (nearest.tests >= pass_range.z && !walk.ended) walk.stalled = true;
}
#else
void start_walk() { walk.at = ivec2(0, 0); }

void walk_tree() {
  int address = walk.at.x;
  int end = min(pass_range.z, pass_image.w);
  while (address < end && nearest.pending < 0) {
    test_primitive(address);
    address = next_primitive(address);
  }
  walk.at.x = address;
  walk.ended = address >= pass_image.w;
}
#endif
