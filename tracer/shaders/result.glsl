// SPDX-License-Identifier: MIT
// What becomes of a walk: words of a hit, or the state in which another pass goes on.

uvec4 result_0;  // kind + 8 * primitive, t, steps, primitives tested
uvec4 result_1;  // position, weight of the second corner
uvec4 result_2;  // normal, weight of the third corner
#ifdef HAS_TRANSFORMS
uvec4 result_3;  // instance + 1, or 0 in the world; transforms entered; 0; 0
#endif

void write_unfinished() {
  result_0 = uvec4(KIND_UNFINISHED + 8u * uint(nearest.pending + 1), floatBitsToUint(nearest.t), walk.steps, nearest.tests);
  result_1 = uvec4(walk.at, walk.cluster_at, walk.cluster_next);
  result_2 = uvec4(floatBitsToUint(nearest.label), floatBitsToUint(nearest.weights), nearest.address);
#ifdef HAS_TRANSFORMS
  result_0.y = floatBitsToUint(nearest.t_world);
  result_3 = uvec4(floatBitsToUint(nearest.t_space), nearest.space, walk.space, walk.transforms);
#endif
}

// True where the result is complete: a driver may have ended the loops that bring it out of nested transforms.
bool write_result(float t_max) {
  bool hit = walk.ended && nearest.label < NO_LABEL;
  bool complete = true;
#ifdef HAS_TRANSFORMS
#ifdef ANY_HIT
  int node = SPACE_WORLD;
  ray = world_ray;
#else
  int node = hit ? nearest.space : SPACE_WORLD;
  derive_ray(node);
#endif
  complete = !ray.cut;
  float t = nearest.t_space;
#else
  float t = nearest.t;
#endif
  vec4 p0 = primitive_0(nearest.address), p1 = primitive_1(nearest.address);
  PRECISE vec3 position = vec3(0.0);
  PRECISE vec3 normal = vec3(0.0);
#ifdef HAS_SPHERES
  normal = sphere_normal(p0.xyz, t);
  position = p0.xyz + p1.x * normal;
#endif
#ifdef HAS_TRIANGLES
  if (p1.w != KIND_SPHERE) {
    vec4 p2 = primitive_2(nearest.address);
    vec2 w = nearest.weights;
    normal = triangle_normal(p0.xyz, p1.xyz, p2.xyz);
    position = ((1.0 - w.x) - w.y) * p0.xyz + w.x * p1.xyz + w.y * p2.xyz;
  }
#endif
#ifdef HAS_TRANSFORMS
  // Out of the instance, level by level; a broken record may lead in a circle.
  int level = 0;
  for (; node >= 0 && level < MAX_DEPTH; ++level) {
    if (node >= 0) {
      vec4 back_0 = record_texel(node, 0), back_1 = record_texel(node, 1), back_2 = record_texel(node, 2);
      vec4 row_0 = record_texel(node, 3), row_1 = record_texel(node, 4), row_2 = record_texel(node, 5);
      position = times(row_0, row_1, row_2, position) + vec3(back_0.w, back_1.w, back_2.w);
      normal = times_transposed(back_0, back_1, back_2, normal);
      normal *= power_of_two(clamp(-largest_exponent(normal), -126, 127));
      node = int(row_0.w) - 1;
    }
  }
  complete = complete && node < 0;
  normal *= hit && nearest.space >= 0 ? 1.0 / sqrt(dot(normal, normal)) : 1.0;
  ray = world_ray;
  t = nearest.t_world;
#endif
  uvec3 position_bits = floatBitsToUint(position);
  if (pass_range.x != 0) {
    uvec3 sign_bits = position_bits & uvec3(0x80000000u);
    position = abs(position);
    position_bits = sign_bits | uvec3(scaled_bits(position.x, -pass_range.x), scaled_bits(position.y, -pass_range.x),
                                      scaled_bits(position.z, -pass_range.x));
  }
  uint kind = !ray.defined ? KIND_UNDEFINED : !walk.ended ? KIND_CAPPED : hit ? KIND_HIT : KIND_MISS;
  uint primitive = hit ? uint(nearest.label) - 1u : 0u;
  result_0 = uvec4(kind + 8u * primitive, given_t(t, t_max), walk.steps, nearest.tests);
  result_1 = uvec4(position_bits, floatBitsToUint(nearest.weights.x));
  result_2 = uvec4(floatBitsToUint(normal), floatBitsToUint(nearest.weights.y));
#ifdef HAS_TRANSFORMS
  result_3 = uvec4(hit ? uint(nearest.space + 1) : 0u, walk.transforms, 0u, 0u);
#endif
  return complete;
}
