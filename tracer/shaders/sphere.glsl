// SPDX-License-Identifier: MIT
// Ray and sphere: the foot of the perpendicular from the centre, and half the chord to either side of it.

// The t of the first of the two roots that is above t_low; false where the ray's line misses.
bool intersect_sphere(vec3 center, float radius, out float t) {
  vec3 m = center - ray.o;
  float foot = dot(m, ray.dn);
  vec3 f = m - foot * ray.d;
  float rest = radius * radius - dot(f, f);
  float half_chord = sqrt(max(rest, 0.0) * ray.inverse_d2);
  float enter = foot - half_chord;
  t = enter > ray.t_low ? enter : foot + half_chord;
#ifdef CAPTURE
  captured.sphere = vec4(foot, half_chord, rest, 0.0);
#endif
  return rest >= 0.0;
}

// From the centre to the point at t, of unit length.
vec3 sphere_normal(vec3 center, float t) {
  vec3 n = t * ray.d - (center - ray.o);
  return n * (1.0 / sqrt(dot(n, n)));
}
