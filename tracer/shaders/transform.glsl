// SPDX-License-Identifier: MIT
// Transforms: rays go into the space of a node and come out again, and so does what was hit there (the paper, section
// 6). A ray keeps its t: what is walked with is o + t d in the space at hand, and t_scale and t_shift lead back to the
// world's t.

PRECISE WalkRay world_ray;
#ifdef OUT_INVERSE
PRECISE vec3 entered_o, entered_d;  // the ray of the space at hand, as it was right after it went in
#endif

// Products in a fixed order: matrix by rows, and its transpose.
vec3 times(vec4 row_0, vec4 row_1, vec4 row_2, vec3 v) {
  PRECISE vec3 product = vec3((row_0.x * v.x + row_0.y * v.y) + row_0.z * v.z,
                              (row_1.x * v.x + row_1.y * v.y) + row_1.z * v.z,
                              (row_2.x * v.x + row_2.y * v.y) + row_2.z * v.z);
  return product;
}
vec3 times_transposed(vec4 row_0, vec4 row_1, vec4 row_2, vec3 v) {
  PRECISE vec3 product = (row_0.xyz * v.x + row_1.xyz * v.y) + row_2.xyz * v.z;
  return product;
}

// Takes the ray into the space of a node that stands in the space at hand.
void enter_space(int node) {
  vec4 row_0 = record_texel(node, 0), row_1 = record_texel(node, 1), row_2 = record_texel(node, 2);
  PRECISE vec3 o = times(row_0, row_1, row_2, ray.o - vec3(row_0.w, row_1.w, row_2.w));
  PRECISE vec3 d = times(row_0, row_1, row_2, ray.d);
  float scale = ray.t_scale, shift = ray.t_shift;
#ifdef OUT_INVERSE
  entered_o = o;
  entered_d = d;
#endif
  int largest = largest_bits(d);
  bool usable = largest > 0 && largest < 0x7f800000 && largest_bits(o) < 0x7f800000;
  aim_ray(usable ? o : vec3(0.0), usable ? d : vec3(0.0, 0.0, 1.0), record_texel(node, 6));
  float unit = power_of_two(clamp(ray.exponent, -126, 127));
  ray.t_scale = (scale * ray.shift_unit) * unit;
  ray.t_shift = (scale * unit) * (ray.shift_high + ray.shift_low) + shift;
  ray.misses = ray.misses || !usable;
}

// Derives the ray of a space from the world's, through all spaces around it: the very bits that it had on its way in.
// A driver may end all loops of an invocation without a word; then ray.cut is set.
void derive_ray(int space) {
  // No deeper than nodes nest, whatever a broken record says: the loops below take the square of it.
  int depth = space == SPACE_WORLD ? 0 : min(int(record_texel(space, 7).z), MAX_DEPTH);
  ray = world_ray;
  bool cut = false;
  int level = 1;
  for (; level <= depth; ++level) {
    int node = space;
    int above = depth;
    for (; above > level; --above) {
      if (above > level) node = int(record_texel(node, 3).w) - 1;
    }
    // A pixel that has left the loop must not change its ray, although this driver runs the body for it (Mesa 22.3).
    if (level <= depth) {
      cut = cut || above > level;
      enter_space(node);
      cut = cut || ray.cut;
    }
  }
  ray.cut = cut || level <= depth;
}
