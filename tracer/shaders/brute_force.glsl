// SPDX-License-Identifier: MIT
// A loop over all primitives in place of the walk: what the tree lost, this finds. It shares all of the arithmetic on
// primitives.

void start_walk() { walk.at = ivec2(0, 0); }

void walk_tree() {
  int address = walk.at.x;
  while (address < pass_range.z && nearest.pending < 0) {
    test_primitive(address);
    address = next_primitive(address);
  }
  walk.at.x = address;
  walk.ended = address >= pass_image.w;
}
