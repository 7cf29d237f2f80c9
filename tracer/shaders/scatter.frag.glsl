// SPDX-License-Identifier: MIT
// The rays that leave each hit: the reflected and the refracted one (SEMANTICS 6.7). No direction where there is none.

layout(location = 0) out vec4 out_0;  // reflected: origin, t_max
layout(location = 1) out vec4 out_1;  // direction, weight
layout(location = 2) out vec4 out_2;  // refracted, likewise
layout(location = 3) out vec4 out_3;

void main() {
  Surface s = surface_at_item();
  vec3 d = s.from.d;
  vec4 used = vec4(0.0);
  bool reflects = s.is_hit && s.ks > 0.0;
  vec3 n = s.n;
  if (reflects && s.glossy > 0.0) {
    used = random_block(pixel_number(), frame_number(), uint(u_sample.y), BLOCK_NORMAL);
    vec3 p = in_ball(used.xyz);
    vec3 sum = n + s.glossy * p;
#ifdef TAP_PLACES
    used.xyz = p;
#endif
    n = sum == vec3(0.0) ? n : unit(sum);
  }
  vec3 above = s.p + s.delta * s.facing;
  vec3 mirrored = d - 2.0 * dot(d, n) * n;
  float inwards = dot(mirrored, s.facing);
  mirrored = inwards < 0.0 ? mirrored - 2.0 * inwards * s.facing : mirrored;
  out_0 = reflects ? vec4(above, INFINITE) : vec4(0.0);
  out_1 = reflects ? vec4(unit(mirrored), s.from.weight * s.ks) : vec4(0.0);

  bool passes = s.is_hit && s.transmittance > 0.0;
  float eta = dot(d, s.outside) > 0.0 ? s.index : 1.0 / s.index;
  float c = -dot(d, s.n);
  float k = 1.0 - eta * eta * (1.0 - c * c);
  bool is_total = k < 0.0;
  // Total internal reflection stays on this side, by the normal as it is; what passes goes on beyond.
  vec3 refracted = is_total ? d + 2.0 * c * s.n : eta * d + (eta * c - sqrt(max(k, 0.0))) * s.n;
  vec3 side = is_total ? s.facing : -s.facing;
  float wrong_way = dot(refracted, side);
  refracted = wrong_way < 0.0 ? refracted - 2.0 * wrong_way * side : refracted;
  out_2 = passes ? vec4(s.p + s.delta * side, INFINITE) : vec4(0.0);
  out_3 = passes ? vec4(unit(refracted), s.from.weight * s.transmittance) : vec4(0.0);
#ifdef TAP
  out_0 = used;
#endif
}
