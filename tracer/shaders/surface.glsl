// SPDX-License-Identifier: MIT
// The surface at a hit (SEMANTICS 6.4, 6.5, 6.8): from what the walk has found, the scene's numbers and textures.

#ifdef BUFFER_TEXTURES
uniform samplerBuffer u_shading, u_textures;
vec4 shading_texel(int i) { return texelFetch(u_shading, i); }
vec3 texture_texel(int i) { return texelFetch(u_textures, i).xyz; }
#else
uniform sampler2D u_shading, u_textures;
vec4 shading_texel(int i) { return texelFetch(u_shading, ivec2(i % SHADING_WIDTH, i / SHADING_WIDTH), 0); }
vec3 texture_texel(int i) { return texelFetch(u_textures, ivec2(i % SHADING_WIDTH, i / SHADING_WIDTH), 0).xyz; }
#endif
uniform sampler2D u_ray_origins, u_ray_directions;
uniform usampler2D u_hit_0, u_hit_1, u_hit_2, u_hit_3;

uniform ivec4 u_starts;  // where materials, textures, triangles, spheres begin
uniform ivec4 u_scene;   // where instances begin, number of triangles, where lights begin in the geometry image, number of lights
uniform vec4 u_effects;  // glossiness of the scene; 1 where lights are soft, 1 where reflections are glossy, 0

struct GivenRay {
  vec3 o, d;
  float t_max, weight;
};
GivenRay given_ray(sampler2D origins, sampler2D directions) {
  vec4 a = texelFetch(origins, item(), 0), b = texelFetch(directions, item(), 0);
  return GivenRay(a.xyz, b.xyz, a.w, b.w);
}

// Where a ray meets the round ground; a negative number where it does not.
float meet_ground(GivenRay r) {
  vec4 place = shading_texel(0);
  vec3 normal = shading_texel(1).xyz;
  float along = dot(r.d, normal);
  float t = dot(place.xyz - r.o, normal) / along;
  vec3 from_center = (r.o - place.xyz) + t * r.d;
  bool is_met = along != 0.0 && t > 0.0 && t <= r.t_max && dot(from_center, from_center) <= place.w * place.w && place.w > 0.0;
  return is_met ? t : -1.0;
}

struct Surface {
  bool is_hit;
  bool is_wrong;   // the walk found no end
  GivenRay from;
  vec3 p;          // where
  vec3 outside;    // N, the geometric normal, unit length
  vec3 facing;     // n_g: N turned towards the ray
  vec3 n;          // the shading normal, bumped, turned as n_g
  float delta;     // where rays that leave start, across the surface
  vec3 color;      // C
  float kd, ks, shine, transmittance, index, glossy;
};

int texture_place(int start, ivec2 size, ivec2 at) {
  ivec2 wrapped = (at + 2 * size) % size;  // at least -2 before

  return start + wrapped.y * size.x + wrapped.x;
}

// Bilinear lookup, wrapped both ways. `steps` are the texels whose difference is filtered: that at +steps less that at
// -steps; zero for the texel itself.
vec3 look_up(int number, vec2 uv, ivec2 steps, out ivec2 size) {
  vec4 place = shading_texel(u_starts.y + number);
  int start = int(place.x) * TEXTURE_BLOCK + int(place.y);
  size = ivec2(place.zw);
  vec2 at = vec2(uv.x - floor(uv.x), 1.0 - (uv.y - floor(uv.y))) * vec2(size) - 0.5;
  vec2 whole = floor(at), f = at - whole;
  ivec2 i = ivec2(whole);
  vec3 a = texture_texel(texture_place(start, size, i + steps));
  vec3 b = texture_texel(texture_place(start, size, i + ivec2(1, 0) + steps));
  vec3 c = texture_texel(texture_place(start, size, i + ivec2(0, 1) + steps));
  vec3 d = texture_texel(texture_place(start, size, i + ivec2(1, 1) + steps));
  if (steps != ivec2(0)) {
    a -= texture_texel(texture_place(start, size, i - steps));
    b -= texture_texel(texture_place(start, size, i + ivec2(1, 0) - steps));
    c -= texture_texel(texture_place(start, size, i + ivec2(0, 1) - steps));
    d -= texture_texel(texture_place(start, size, i + ivec2(1, 1) - steps));
  }
  return (1.0 - f.y) * ((1.0 - f.x) * a + f.x * b) + f.y * ((1.0 - f.x) * c + f.x * d);
}

// The normal m bumped by the height map `number` (Blinn 1978). Pu and Pv are the derivatives of the place.
vec3 bump(vec3 m, int number, float scale, vec2 uv, vec3 pu, vec3 pv) {
  ivec2 size;
  float fu = look_up(number, uv, ivec2(1, 0), size).x;
  float fv = look_up(number, uv, ivec2(0, -1), size).x;  // rows go down, v goes up
  fu *= scale * 0.5 * float(size.x);
  fv *= scale * 0.5 * float(size.y);
  float volume = dot(m, cross(pu, pv));
  vec3 bumped = unit(m - (fu * cross(pv, m) + fv * cross(m, pu)) * (1.0 / volume));
  return abs(volume) > 0.0 && abs(volume) < INFINITE ? bumped : m;
}

Surface surface_at_item() {
  ivec2 at = item();
  uvec4 hit_0 = texelFetch(u_hit_0, at, 0);
  uint kind = hit_0.x & 7u;
  uint primitive = hit_0.x >> 3;
  vec3 position = uintBitsToFloat(texelFetch(u_hit_1, at, 0).xyz);
  vec3 normal = uintBitsToFloat(texelFetch(u_hit_2, at, 0).xyz);
  vec2 weights = uintBitsToFloat(uvec2(texelFetch(u_hit_1, at, 0).w, texelFetch(u_hit_2, at, 0).w));
#ifdef HAS_TRANSFORMS
  int instance = int(texelFetch(u_hit_3, at, 0).x) - 1;
#else
  const int instance = -1;
#endif

  Surface s;
  s.from = given_ray(u_ray_origins, u_ray_directions);
  s.is_wrong = kind != KIND_MISS && kind != KIND_HIT && kind != KIND_UNDEFINED;
  s.is_hit = kind == KIND_HIT;
  s.p = position;
  s.outside = normal;
  s.n = normal;

  // The primitive's own numbers, in its space.
  vec3 reach = vec3(0.0);  // E of SEMANTICS 6.5 ...
  float size = 0.0;        // ... and D
  vec2 uv = vec2(0.0);
  bool has_uv = false;
  vec3 shading_normal = vec3(0.0);
  vec3 pu = vec3(0.0), pv = vec3(0.0);
  int material = 0;
#ifdef HAS_TRANSFORMS
  vec4 out_x = vec4(1.0, 0.0, 0.0, 0.0), out_y = vec4(0.0, 1.0, 0.0, 0.0), out_z = vec4(0.0, 0.0, 1.0, 0.0);
  vec4 in_x = out_x, in_y = out_y, in_z = out_z;
  if (instance >= 0) {
    int place = u_scene.x + INSTANCE_TEXELS * instance;
    out_x = shading_texel(place), out_y = shading_texel(place + 1), out_z = shading_texel(place + 2);
    in_x = shading_texel(place + 3), in_y = shading_texel(place + 4), in_z = shading_texel(place + 5);
  }
  // N in the part's space: normals go in by the transpose of what takes points out.
  vec3 part_normal = unit(out_x.xyz * normal.x + out_y.xyz * normal.y + out_z.xyz * normal.z);
#else
  vec3 part_normal = normal;
#endif
#ifdef HAS_TRIANGLES
  if (int(primitive) < u_scene.y && s.is_hit) {
    int place = u_starts.z + SHADING_TRIANGLE_TEXELS * int(primitive);
    vec4 t0 = shading_texel(place), t1 = shading_texel(place + 1), t2 = shading_texel(place + 2);
    vec4 t3 = shading_texel(place + 3), t4 = shading_texel(place + 4), t5 = shading_texel(place + 5);
    vec4 t6 = shading_texel(place + 6);
    material = int(t0.w);
    reach = max(max(abs(t0.xyz), abs(t1.xyz)), abs(t2.xyz));
    vec3 box = max(max(t0.xyz, t1.xyz), t2.xyz) - min(min(t0.xyz, t1.xyz), t2.xyz);
    size = max(max(box.x, box.y), box.z);
    float first = (1.0 - weights.x) - weights.y;
    vec3 sum = unit(first * t3.xyz + weights.x * t4.xyz + weights.y * t5.xyz);
    if (t1.w > 0.0) shading_normal = dot(sum, part_normal) < 0.0 ? -sum : sum;
    has_uv = t2.w > 0.0;
    vec2 uv0 = vec2(t3.w, t4.w), uv1 = vec2(t5.w, t6.x), uv2 = t6.yz;
    uv = first * uv0 + weights.x * uv1 + weights.y * uv2;
    vec2 a = uv1 - uv0, b = uv2 - uv0;
    vec3 e = t1.xyz - t0.xyz, f = t2.xyz - t0.xyz;
    PRECISE float d = a.x * b.y - b.x * a.y;  // 0 where the coordinates span nothing
    if (d != 0.0) {
      pu = (b.y * e - a.y * f) * (1.0 / d);
      pv = (a.x * f - b.x * e) * (1.0 / d);
    }
  }
#endif
#ifdef HAS_SPHERES
  if (int(primitive) >= u_scene.y && s.is_hit) {
    int place = u_starts.w + SHADING_SPHERE_TEXELS * (int(primitive) - u_scene.y);
    vec4 ball = shading_texel(place);
    material = int(shading_texel(place + 1).x);
    reach = abs(ball.xyz) + ball.w;
  }
#endif

  // The round ground, where it is nearer.
  float t_ground = meet_ground(s.from);
  bool on_ground = t_ground > 0.0 && (!s.is_hit || t_ground < uintBitsToFloat(hit_0.y)) && !s.is_wrong;
  if (on_ground) {
    vec4 place = shading_texel(0), plane = shading_texel(1), u_axis = shading_texel(2), v_axis = shading_texel(3);
    s.is_hit = true;
    vec3 from_center = (s.from.o - place.xyz) + t_ground * s.from.d;
    from_center -= dot(from_center, plane.xyz) * plane.xyz;
    s.p = place.xyz + from_center;
    s.outside = plane.xyz;
    part_normal = plane.xyz;
    shading_normal = vec3(0.0);
    material = int(u_axis.w);
    reach = max(abs(place.xyz), abs(s.p));
    size = 0.0;
    has_uv = true;
    uv = vec2(dot(from_center, u_axis.xyz), dot(from_center, v_axis.xyz)) * (1.0 / plane.w);
    pu = plane.w * u_axis.xyz;
    pv = plane.w * v_axis.xyz;
  }

  int place = u_starts.x + MATERIAL_TEXELS * material;
  vec4 m0 = shading_texel(place), m1 = shading_texel(place + 1), m2 = shading_texel(place + 2);
  s.color = m0.xyz;
  s.kd = m0.w;
  s.ks = m1.x;
  s.shine = m1.y;
  s.transmittance = m1.z;
  s.index = m1.w > 0.0 ? m1.w : 1.0;
  s.glossy = u_effects.z > 0.0 ? (m2.w < 0.0 ? u_effects.x : m2.w) : 0.0;

  vec3 m = shading_normal == vec3(0.0) ? part_normal : shading_normal;
#ifdef HAS_TEXTURES
  if (has_uv && m2.x > 0.0) {
    ivec2 size;
    s.color *= look_up(int(m2.x) - 1, uv, ivec2(0), size);
  }
  if (has_uv && m2.y > 0.0) m = bump(m, int(m2.y) - 1, m2.z, uv, pu, pv);
#endif
#ifdef HAS_TRANSFORMS
  if (instance >= 0 && !on_ground) {
    m = unit(in_x.xyz * m.x + in_y.xyz * m.y + in_z.xyz * m.z);
    vec3 rows = vec3(dot(abs(out_x.xyz), vec3(1.0)), dot(abs(out_y.xyz), vec3(1.0)), dot(abs(out_z.xyz), vec3(1.0)));
    size *= max(max(rows.x, rows.y), rows.z);
    // |L| |L^-1| (|L| e + |T|)
    vec3 taken_out = vec3(dot(abs(out_x.xyz), reach) + abs(out_x.w), dot(abs(out_y.xyz), reach) + abs(out_y.w),
                          dot(abs(out_z.xyz), reach) + abs(out_z.w));
    vec3 taken_in = vec3(dot(abs(in_x.xyz), taken_out), dot(abs(in_y.xyz), taken_out), dot(abs(in_z.xyz), taken_out));
    reach = vec3(dot(abs(out_x.xyz), taken_in), dot(abs(out_y.xyz), taken_in), dot(abs(out_z.xyz), taken_in));
  }
#endif
  bool is_turned = dot(s.from.d, s.outside) > 0.0;
  s.facing = is_turned ? -s.outside : s.outside;
  s.n = is_turned ? -m : m;
  s.delta = DELTA * (dot(abs(s.outside), reach) + size);
  return s;
}
