uniform ivec4 u_random;
vec4 random_block(uint pixel, uint frame, uint ray, uint block) {
  uvec4 v = uvec4(pixel, frame ^ uint(u_random.y), ray + 64u * block, uint(u_random.x));
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w; v.y += v.z * v.x; v.z += v.x * v.y; v.w += v.y * v.z;
  return vec4(v >> 8u) * 5.9604644775390625e-8;
}
