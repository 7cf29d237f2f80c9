// SPDX-License-Identifier: MIT
// A loop over all primitives in place of the walk: what the tree lost, this finds. It shares all of the arithmetic on primitives.

uniform int u_range_end;  // the primitives of this pass end before this address

void start_walk() { walk.at = ivec2(0, 0); }

void walk_tree() {
  int address = walk.at.x;
  while (address < u_range_end && nearest.pending < 0) {
    test_primitive(address);
    address = next_primitive(address);
  }
  walk.at.x = address;
  walk.ended = address >= u_primitive_count;
}
