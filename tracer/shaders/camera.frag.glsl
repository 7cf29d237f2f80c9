// SPDX-License-Identifier: MIT
// The primary ray of each sample (SEMANTICS 6.2).

uniform vec4 u_eye;      // position; radius of the lens, 0 for none
uniform vec4 u_right;    // axes of the camera; in w: the slope between neighbouring pixels
uniform vec4 u_up;       // in w: distance of what is sharp
uniform vec4 u_forward;  // in w: 1 where the place in the pixel is random
uniform vec4 u_center;   // of the picture in pixels

layout(location = 0) out vec4 out_0;  // origin, t_max
layout(location = 1) out vec4 out_1;  // direction, weight of what the ray brings

void main() {
  vec4 used = vec4(0.5);
  if (u_forward.w > 0.0) used = random_block(pixel_number(), frame_number(), 1u, BLOCK_PIXEL);
  vec2 place = (vec2(picture_pixel()) - u_center.xy) + (used.xy - 0.5);  // near the axis no bit is lost
  vec3 s = u_forward.xyz + u_right.w * (place.x * u_right.xyz - place.y * u_up.xyz);
  vec3 origin = u_eye.xyz;
  vec3 direction = s;
#ifdef TAP_LENS
  used = vec4(0.0);
#endif
  if (u_eye.w > 0.0) {
    vec4 lens = random_block(pixel_number(), frame_number(), 1u, BLOCK_LENS);
    vec3 p = u_eye.w * in_lens(lens.xyz);
    vec3 shift = p.x * u_right.xyz + p.y * u_up.xyz + p.z * u_forward.xyz;
    origin = u_eye.xyz + shift;
    direction = u_up.w * s - shift;  // to the focal point, without the rounding of the eye's coordinates
#if defined(TAP_LENS) && defined(TAP_PLACES)
    used = vec4(in_lens(lens.xyz), 0.0);
#elif defined(TAP_LENS)
    used = lens;
#endif
  }
  out_0 = vec4(origin, INFINITE);
  out_1 = vec4(unit(direction), 1.0);
#ifdef TAP
  out_0 = used;
#endif
}
