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
};

Walk walk;
