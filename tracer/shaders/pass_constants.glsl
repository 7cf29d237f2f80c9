// SPDX-License-Identifier: MIT
// What is the same for every pixel of a pass. The vertex shader hands it to the pixels as flat varyings: they are at
// hand, while this driver (llvmpipe) loads a uniform eight times over and checks its bounds wherever it is used.

PASS_CONSTANT vec4 pass_ball;    // the scene's ball in image units: centre, radius
PASS_CONSTANT vec4 pass_factor;  // 1 (which the compiler can't know), 1 / image width, 1 / image height, 0
PASS_CONSTANT ivec4 pass_image;  // image width - 1, log2(image width), where primitives start, how many there are
PASS_CONSTANT ivec4 pass_walk;   // size of a copy of the tree, 7 or 0 (a copy per octant or one), payload mask, step limit
PASS_CONSTANT ivec4 pass_range;  // image units = world units * 2^this; 1 where walks are resumed; end of the primitives of a brute-force pass; first event of a capturing pass
PASS_CONSTANT ivec4 pass_size;   // columns and rows of the pass, 0, 0
PASS_CONSTANT ivec4 pass_transforms;  // where records start, how many there are, primitives of the world, events of a capturing pass
