// SPDX-License-Identifier: MIT
// One triangle that covers the viewport, and the constants of the pass.

uniform vec4 u_ball;
uniform vec4 u_factor;
uniform ivec4 u_image;
uniform ivec4 u_walk;
uniform ivec4 u_range;
uniform ivec4 u_size;
uniform ivec4 u_transforms;

void main() {
  pass_ball = u_ball;
  pass_factor = u_factor;
  pass_image = u_image;
  pass_walk = u_walk;
  pass_range = u_range;
  pass_size = u_size;
  pass_transforms = u_transforms;
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
