// SPDX-License-Identifier: MIT
// Directions.

// Of unit length; zero stays zero. Squares neither overflow nor vanish where the largest component lies
// between 2^-126 and 2^126.
vec3 unit(vec3 v) {
  vec3 size = abs(v);
  float largest = max(max(size.x, size.y), size.z);
  vec3 w = v * (1.0 / largest);
  return largest > 0.0 ? w * (1.0 / sqrt(dot(w, w))) : v;
}
