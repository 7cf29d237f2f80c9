// SPDX-License-Identifier: MIT
// Where rays come from, and how a ray and its walk begin.

// Texels 2 i and 2 i + 1 are origin and t_max, direction and 0 of the ray of pixel i, counted row by row.
#ifdef RENDERING
// Rays that a shader has made stand in two textures.
uniform sampler2D u_ray_origins, u_ray_directions;
vec4 ray_texel(int i) {
  ivec2 at = ivec2((i >> 1) % BATCH_WIDTH, (i >> 1) / BATCH_WIDTH);
  return (i & 1) == 0 ? texelFetch(u_ray_origins, at, 0) : texelFetch(u_ray_directions, at, 0);
}
#elif defined(BUFFER_TEXTURES)
uniform samplerBuffer u_rays;
vec4 ray_texel(int i) { return texelFetch(u_rays, i); }
#else
uniform sampler2D u_rays;
vec4 ray_texel(int i) { return texelFetch(u_rays, ivec2(i % (2 * BATCH_WIDTH), i / (2 * BATCH_WIDTH)), 0); }
#endif

// Drivers shade whole blocks of pixels, and llvmpipe's loops go on, and are cut off, for a block as one. So pixels beyond the
// pass do what its last ones do: from what stands there, of earlier passes or nobody's, a walk may go round for ever.
ivec2 pixel_of_pass() { return min(ivec2(gl_FragCoord.xy), pass_size.xy - 1); }

void start() {
  walk.cluster_at = -1;
  walk.cluster_next = 0;
  walk.steps = 0;
  walk.ended = false;
  nearest.t = ray.t_best;
  nearest.label = NO_LABEL;
  nearest.address = 0;
  nearest.weights = vec2(0.0);
  nearest.tests = 0;
  nearest.pending = -1;
#ifdef HAS_TRANSFORMS
  world_ray = ray;
  walk.space = SPACE_WORLD;
  walk.request = REQUEST_NONE;
  walk.transforms = 0;
  walk.stalled = false;
  nearest.t_world = ray.t_best;
  nearest.t_space = 0.0;
  nearest.space = SPACE_NONE;
#endif
}
