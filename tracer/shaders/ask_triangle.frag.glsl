// SPDX-License-Identifier: MIT
// What triangle.glsl says of a ray and a triangle: five texels of a row are origin and direction, then the corners.

uniform sampler2D u_input;
layout(location = 0) out uvec4 answer;  // inside, 2 * edge_on, 4 * inside once resolved; the normal

vec3 given(int i) { return texelFetch(u_input, ivec2(i, int(gl_FragCoord.y)), 0).xyz; }

void main() {
  prepare_ray(given(0), given(1), uintBitsToFloat(0x7f800000u));
  TriangleHit hit = intersect_triangle(given(2), given(3), given(4));
  TriangleHit resolved = resolve_edge_on(given(2), given(3), given(4));
  uint flags = (hit.inside ? 1u : 0u) + (hit.edge_on ? 2u : 0u) + (resolved.inside ? 4u : 0u);
  answer = uvec4(flags, floatBitsToUint(triangle_normal(given(2), given(3), given(4))));
}
