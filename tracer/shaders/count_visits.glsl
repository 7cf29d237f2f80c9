// SPDX-License-Identifier: MIT
// Counts, for every node of the image, how often walks visit it and how often they find it hit. Only in programs that
// inspect an image; nothing of it is in the production's text.
#extension GL_ARB_shader_storage_buffer_object : require

layout(std430) buffer Visits { uint visits[]; };  // of unit i: [2 i] how often it was visited, [2 i + 1] hit

void count_visit(int unit, bool is_hit) {
  int at = 2 * unit;
  if (at >= 0 && at + 1 < visits.length()) {
    atomicAdd(visits[at], 1u);
    if (is_hit) atomicAdd(visits[at + 1], 1u);
  }
}
