// SPDX-License-Identifier: MIT
// Ray and triangle: watertight after Woop, Benthin and Wald 2013 ("Watertight Ray/Triangle Intersection", JCGT 2(1)).
// The corners are projected along the ray; where the ray passes is told by three edge functions, whose floats on a
// shared edge are each other's negatives bit by bit, since nothing is fused or reordered.

// A corner as the ray sees it: x, y across the ray in units of the permuted axes, z along its largest axis.
vec3 project(vec3 corner) {
  vec3 p = permute(corner - ray.o);
  return vec3(p.xy - ray.shear.xy * p.z, p.z);
}

// Twice the signed area of (ray, p, q) in projection.
float edge_function(vec3 p, vec3 q) { return p.x * q.y - p.y * q.x; }

struct TriangleHit {
  float t;         // NaN or infinite where there is none
  vec2 weights;    // of the second and the third corner
  bool inside;     // the edge functions do not contradict one another; edges and corners belong to the triangle
  bool edge_on;    // their rounding errors matter: t and weights are to be had from resolve_edge_on
};

TriangleHit intersect_triangle(vec3 corner_a, vec3 corner_b, vec3 corner_c) {
  vec3 a = project(corner_a), b = project(corner_b), c = project(corner_c);
  float u = edge_function(c, b), v = edge_function(a, c), w = edge_function(b, a);
  float det = (u + v) + w;
  float far2 = max(max(dot(a.xy, a.xy), dot(b.xy, b.xy)), dot(c.xy, c.xy));
  float inverse = 1.0 / det;
  TriangleHit hit;
  hit.inside = min(min(u, v), w) >= 0.0 || max(max(u, v), w) <= 0.0;
  hit.edge_on = abs(det) < max(EDGE_ON * far2, LEAST_DET);
  hit.t = (((u * a.z + v * b.z) + w * c.z) * inverse) * ray.shear.z;
  hit.weights = vec2(v, w) * inverse;
#ifdef CAPTURE
  captured.numbers = vec4(u, v, w, det);
#endif
  return hit;
}

// A triangle seen nearly edge-on, or so small that it seems so, that intersect_triangle found to be inside: there the
// edge functions are mostly rounding error and tell neither where along the sliver the ray passes nor that it does not
// pass far beside it. They are computed again, exactly but for the last place. It stays watertight: a neighbour that is
// not seen edge-on takes at least what its exact edge functions would give it, since rounding turns them to zero at
// worst, and zero is inside.
TriangleHit resolve_edge_on(vec3 corner_a, vec3 corner_b, vec3 corner_c) {
  vec3 a = project(corner_a), b = project(corner_b), c = project(corner_c);
  float u = difference_of_products(c.x, b.y, c.y, b.x);
  float v = difference_of_products(a.x, c.y, a.y, c.x);
  float w = difference_of_products(b.x, a.y, b.y, a.x);
  float det = (u + v) + w;
  vec3 weights = vec3(u, v, w) * (1.0 / det);
  TriangleHit hit;
  hit.inside = (min(min(u, v), w) >= 0.0 || max(max(u, v), w) <= 0.0) && abs(det) >= LEAST_DET;
  hit.edge_on = false;
  hit.t = ((weights.x * a.z + weights.y * b.z) + weights.z * c.z) * ray.shear.z;
  hit.weights = weights.yz;
#ifdef CAPTURE
  captured.numbers = vec4(u, v, w, det);
#endif
  return hit;
}

// The greatest exponent among the components.
int largest_exponent(vec3 v) {
  ivec3 bits = floatBitsToInt(abs(v));
  return (max(max(bits.x, bits.y), bits.z) >> 23) - 127;
}

// (b - a) x (c - a), of unit length. Edges and product are brought to a size near 1, so that nothing underflows. Where
// the edges are parallel after rounding, any perpendicular must do.
vec3 triangle_normal(vec3 corner_a, vec3 corner_b, vec3 corner_c) {
  vec3 e = corner_b - corner_a, f = corner_c - corner_a;
  e *= power_of_two(clamp(-largest_exponent(e), -126, 127));
  f *= power_of_two(clamp(-largest_exponent(f), -126, 127));
  vec3 n = vec3(difference_of_products(e.y, f.z, e.z, f.y), difference_of_products(e.z, f.x, e.x, f.z),
                difference_of_products(e.x, f.y, e.y, f.x));
  n *= power_of_two(clamp(-largest_exponent(n), -126, 127));
  bool parallel = !(dot(n, n) > 0.0);
  n = parallel ? (e.x == 0.0 && e.y == 0.0 ? vec3(1.0, 0.0, 0.0) : vec3(-e.y, e.x, 0.0)) : n;
  return n * (1.0 / sqrt(dot(n, n)));
}
