// SPDX-License-Identifier: MIT
// What a captured walk keeps (tracer/walk_trace.h). All pixels of a capturing pass walk the same ray with the production's code; what happens on the
// way is counted, and pixel i keeps event i of the pass. Production programs are composed without this file.

struct Captured {
  int wanted;    // the event that this pixel keeps
  int count;     // events so far
  vec4 numbers;  // of the test at hand: a node's or a triangle's
  vec4 sphere;   // of a sphere's test
  int octant;    // whose copy of the region is walked
  bool full;     // the pass ended only because it had its events
  uvec4 a, b, c;
  uvec3 d;
};
Captured captured;

// A pixel of its own holds no event but the walk's ray, for the next pass.
void start_capture(int pixel) {
  captured.wanted = pixel == CAPTURE_PIXELS - 1 ? 0x7fffffff : pixel + pass_range.w;
  captured.count = 0;
  captured.numbers = vec4(0.0);
  captured.sphere = vec4(0.0);
  captured.octant = 0;
  captured.full = false;
  captured.a = uvec4(0u);
  captured.b = uvec4(0u);
  captured.c = uvec4(0u);
  captured.d = uvec3(0u);
}

void capture_event(uvec4 a, uvec4 b, uvec4 c, uvec3 d) {
  if (captured.count == captured.wanted) {
    captured.a = a;
    captured.b = b;
    captured.c = c;
    captured.d = d;
  }
  ++captured.count;
}

// The pass has as many events as it is meant to have, and the walk stops between two nodes.
bool capture_is_full() { return captured.count >= pass_transforms.w; }

// A sphere's node test: what production compares, and how the ray's whole line passes.
void capture_sphere(vec3 to_center, vec3 f) {
  float foot = dot(to_center, ray.dn);
  vec3 beside = to_center - foot * ray.d;
  captured.numbers = vec4(dot(f, f), foot, dot(beside, beside), 0.0);
}

// A box's.
void capture_slabs(vec3 enter, vec3 leave) {
  captured.numbers = vec4(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z), 0.0, 0.0);
}
