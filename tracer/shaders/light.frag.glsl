// SPDX-License-Identifier: MIT
// What one light brings to each hit if nothing stands in its way, and the shadow ray that asks (SEMANTICS 6.6). Rays
// that hit nothing bring the background, with the first light.

uniform vec4 u_background;

layout(location = 0) out vec4 out_0;  // of the shadow ray: origin, t_max
layout(location = 1) out vec4 out_1;  // direction, 0; no direction where none is sent
layout(location = 2) out vec4 out_2;  // what the light brings; above 0 where a walk found no end

#ifdef LAYOUT_PAPER
vec4 light_texel(int light, int i) { return cell_texel(u_scene.z + light, i); }
#else
vec4 light_texel(int light, int i) { return texel(u_scene.z + LIGHT_TEXELS * light + i); }
#endif

void main() {
  Surface s = surface_at_item();
  int light = u_sample.z;
  vec4 place = light_texel(light, 0), intensity = light_texel(light, 1);
  vec4 used = vec4(0.0);
  vec3 q = place.xyz;
  if (u_effects.y > 0.0 && place.w > 0.0) {
    used = random_block(pixel_number(), frame_number(), uint(u_sample.y), BLOCK_LIGHTS + uint(light));
    vec3 p = in_ball(used.xyz);
    q += place.w * p;
#ifdef TAP_PLACES
    used.xyz = p;
#endif
  }
  vec3 l = unit(q - s.p);
  float along = dot(s.n, l);
  bool is_asked = s.is_hit && dot(s.facing, l) > 0.0 && along > 0.0;
  vec3 start = s.p + s.delta * s.facing;
  float n = float(u_scene.w);
  vec3 brightness = intensity.w > 0.0 ? intensity.xyz : vec3(sqrt(n) / (2.0 * n));
  float cosine = dot(s.n, unit(l - s.from.d));
  float highlight = cosine > 0.0 ? power(cosine, s.shine) : 0.0;
  vec3 brought = (s.from.weight * brightness) * (s.kd * along * s.color + s.ks * highlight);
  bool is_sent = s.from.d != vec3(0.0);
  vec3 unlit = !s.is_hit && light == 0 && is_sent ? s.from.weight * u_background.xyz : vec3(0.0);
  out_0 = is_asked ? vec4(start, 1.0) : vec4(0.0);
  out_1 = is_asked ? vec4(q - start, 0.0) : vec4(0.0);
  out_2 = vec4(is_asked ? brought : unlit, s.is_wrong && is_sent ? 1.0 : 0.0);
#ifdef TAP
  out_0 = s.is_hit ? used : vec4(0.0);
#endif
}
