// SPDX-License-Identifier: MIT
// What a walk has to remember when it is interrupted: by a triangle seen edge-on, or by the driver, which may end all
// loops of an invocation after 65,535 iterations without a word (Mesa before 23). Then the host lets it go on in
// another pass.

struct Walk {
  ivec2 at;        // where to go on; what the numbers mean is the layout's matter
  int cluster_at;  // the cluster that was left before its end ...
  int cluster_next;  // ... and the address of its next primitive
  int steps;       // nodes visited
  bool ended;      // the end was reached
#ifdef HAS_TRANSFORMS
  int space;       // the node whose space is walked; SPACE_WORLD
  int request;     // the node to be entered, REQUEST_LEAVE, or REQUEST_NONE
  int transforms;  // entered so far
  bool stalled;    // the walk must go on in another pass
#endif
};

#ifdef HAS_TRANSFORMS
const int SPACE_WORLD = -1;
const int SPACE_NONE = 0x7fffffff;  // of what is not hit yet: greater than every node
const int REQUEST_NONE = -1;
const int REQUEST_LEAVE = -2;
#endif

Walk walk;

// The nearest hit so far.
struct Nearest {
  float t;
  float label;   // the primitive's number + 1; NO_LABEL where nothing is hit yet
  int address;   // where the primitive stands
  vec2 weights;  // barycentrics of the second and the third corner
  int tests;     // primitives tested
  int pending;   // address of a triangle that is seen edge-on and waits for resolve_pending; -1 where there is none
#ifdef HAS_TRANSFORMS
  // Here t only bounds the walk in the space at hand: no nearer hit of that space has a greater one.
  float t_world;  // of the hit, by the world's walking ray
  float t_space;  // of the hit, by the walking ray of the space it is in
  int space;      // the node that shows it
#endif
};

PRECISE Nearest nearest;
