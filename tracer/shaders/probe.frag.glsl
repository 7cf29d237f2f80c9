// SPDX-License-Identifier: MIT
// One ray per pixel: rays come from a texture, results go to three integer targets (four with transforms), whose words no driver converts.

// Read where walks are resumed: what an unfinished pixel wrote.
#ifdef RENDERING
uniform usampler2D u_state_0, u_state_1, u_state_2, u_state_3;
#else
uniform usampler2D u_state;  // STATE_TEXELS texels a pixel
#endif

layout(location = 0) out uvec4 out_0;  // result_0 ... (result.glsl)
layout(location = 1) out uvec4 out_1;
layout(location = 2) out uvec4 out_2;
#ifdef HAS_TRANSFORMS
layout(location = 3) out uvec4 out_3;
#define STATE_TEXELS 4
#else
#define STATE_TEXELS 3
#endif

#ifdef RENDERING
#if FOUND_BUNDLE > 1
// What bundles have found (bundle.frag.glsl), two targets a ray, as the state of their rays.
uniform usampler2D u_found_0, u_found_1, u_found_2, u_found_3;
#if FOUND_BUNDLE > 2
uniform usampler2D u_found_4, u_found_5;
#endif
#if FOUND_BUNDLE > 3
uniform usampler2D u_found_6, u_found_7;
#endif
void fetch_state(ivec2 pixel, out uvec4 s0, out uvec4 s1, out uvec4 s2, out uvec4 s3) {
  ivec2 at = ivec2(pixel.x / FOUND_BUNDLE, pixel.y);
  int lane = pixel.x % FOUND_BUNDLE;
  uvec4 a = texelFetch(u_found_0, at, 0), b = texelFetch(u_found_1, at, 0);
  if (lane == 1) a = texelFetch(u_found_2, at, 0), b = texelFetch(u_found_3, at, 0);
#if FOUND_BUNDLE > 2
  if (lane == 2) a = texelFetch(u_found_4, at, 0), b = texelFetch(u_found_5, at, 0);
#endif
#if FOUND_BUNDLE > 3
  if (lane == 3) a = texelFetch(u_found_6, at, 0), b = texelFetch(u_found_7, at, 0);
#endif
  bool is_alone = uintBitsToFloat(a.y) < 0.0;
#ifdef HAS_TRANSFORMS
  s0 = uvec4(is_alone ? STATE_NEW : STATE_ENDED, b.z, a.w, 0u);
#else
  s0 = uvec4(is_alone ? STATE_NEW : STATE_ENDED, a.x, a.w, 0u);
#endif
  s1 = uvec4(0u);
  s2 = uvec4(a.y, b.xy, a.z);
  s3 = uvec4(a.x, b.w, 0xffffffffu, 0u);  // walks end in the world
}
#else
void fetch_state(ivec2 pixel, out uvec4 s0, out uvec4 s1, out uvec4 s2, out uvec4 s3) {
  s0 = texelFetch(u_state_0, pixel, 0);
  s1 = texelFetch(u_state_1, pixel, 0);
  s2 = texelFetch(u_state_2, pixel, 0);
#ifdef HAS_TRANSFORMS
  s3 = texelFetch(u_state_3, pixel, 0);
#else
  s3 = uvec4(0u);
#endif
}
#endif
#else
void fetch_state(ivec2 pixel, out uvec4 s0, out uvec4 s1, out uvec4 s2, out uvec4 s3) {
  ivec2 at = ivec2(pixel.x * STATE_TEXELS, pixel.y);
  s0 = texelFetch(u_state, at, 0);
  s1 = texelFetch(u_state, at + ivec2(1, 0), 0);
  s2 = texelFetch(u_state, at + ivec2(2, 0), 0);
#ifdef HAS_TRANSFORMS
  s3 = texelFetch(u_state, at + ivec2(3, 0), 0);
#else
  s3 = uvec4(0u);
#endif
}
#endif

#if defined(RENDERING) && defined(THOROUGH)
// Every ray of the batch is drawn again here: those that had ended keep what they had.
uvec4 kept_0, kept_1, kept_2, kept_3;
bool is_kept = false;
#endif

// A pass goes on with what another one has left. The first word tells how: KIND_UNFINISHED, or that a bundle has found
// all that is to be found (STATE_ENDED), or has left the ray alone, to begin anew (STATE_NEW).
void start_or_resume(ivec2 pixel) {
  start();
  start_walk();
  uint how = STATE_NEW;
  uvec4 s0, s1, s2, s3;
  if (pass_range.y != 0) {
    fetch_state(pixel, s0, s1, s2, s3);
    how = s0.x & 7u;
#if defined(RENDERING) && defined(THOROUGH)
    kept_0 = s0, kept_1 = s1, kept_2 = s2, kept_3 = s3;
    is_kept = how != KIND_UNFINISHED;
    if (is_kept) how = STATE_NEW;
#endif
    // A bundle that writes results leaves a ray alone by a state without a label.
    if (how == KIND_UNFINISHED && s2.x == 0u) how = STATE_NEW;
  }
  if (how != STATE_NEW) {
    nearest.pending = int(s0.x >> 3) - 1;
    nearest.t = uintBitsToFloat(s0.y);
    walk.steps = int(s0.z);
    nearest.tests = int(s0.w);
    walk.at = ivec2(s1.xy);
    walk.cluster_at = int(s1.z);
    walk.cluster_next = int(s1.w);
    nearest.label = uintBitsToFloat(s2.x);
    nearest.weights = uintBitsToFloat(s2.yz);
    nearest.address = int(s2.w);
#ifdef HAS_TRANSFORMS
    nearest.t_world = nearest.t;
    nearest.t_space = uintBitsToFloat(s3.x);
    nearest.space = int(s3.y);
    walk.space = int(s3.z);
    walk.transforms = int(s3.w);
    derive_ray(walk.space);
    nearest.t = bound_of(nearest.t_world);
#ifdef CAPTURE
    if (pass_range.y == CAPTURE_GOES_ON) restore_walk(u_state, ivec2((pixel.x + 1) * STATE_TEXELS, pixel.y));
#endif
#endif
  }
  if (how == STATE_ENDED) walk.ended = true;
#ifdef HAS_TRANSFORMS
  if ((world_ray.misses && !world_ray.too_far) || !world_ray.defined) walk.ended = true;
#else
  if ((ray.misses && !ray.too_far) || !ray.defined) walk.ended = true;
#endif
#if defined(RENDERING) && defined(THOROUGH)
  if (is_kept) walk.ended = true;
#endif
}

void main() {
  ivec2 pixel = pixel_of_pass();
  int number = pixel.y * BATCH_WIDTH + pixel.x;
#ifdef CAPTURE
  start_capture(number);
  number = 0;
  pixel = ivec2(0);
#endif
  vec4 origin_and_end = ray_texel(2 * number);
  vec4 direction = ray_texel(2 * number + 1);
  prepare_ray(origin_and_end.xyz, direction.xyz, origin_and_end.w);
  start_or_resume(pixel);
#ifdef CAPTURE
  captured.octant = octant_of(ray.d);
  if (pass_range.y != CAPTURE_GOES_ON) capture_ray(CAPTURE_RAY, -1, ray.misses, nearest.t);
#endif

#ifndef FINISH  // this driver runs the body of a loop once, even where no pixel enters it
#ifdef HAS_TRANSFORMS
  bool is_walking = !walk.ended && !ray.cut;
#ifndef THOROUGH
  is_walking = is_walking && !ray.too_far;
#endif
  while (is_walking) {
    if (is_walking) {
#ifdef THOROUGH
      resolve_pending();
#endif
      walk_tree();
      change_space();
      is_walking = !walk.ended && !walk.stalled && walk.steps < pass_walk.w;
#ifndef THOROUGH
      is_walking = is_walking && nearest.pending < 0;
#endif
#ifdef CAPTURE
      is_walking = is_walking && (nearest.pending >= 0 || !capture_is_full());
#endif
    }
  }
#else
#ifdef THOROUGH
  bool is_walking = !walk.ended;
  while (is_walking) {
    resolve_pending();
    walk_tree();
    is_walking = nearest.pending >= 0;
  }
#else
  if (!walk.ended && !ray.too_far) walk_tree();
#endif
#endif
#endif
  // A ray that waits for a triangle seen edge-on, comes from very far, or whose loops the driver has ended, goes on in another pass with
  // the thorough program: what is rare costs the others nothing there, since this driver runs both sides of every `if`.
#ifdef ANY_HIT
  if (all_have_hit()) nearest.pending = -1;
#endif
  bool unfinished = nearest.pending >= 0 || (!walk.ended && walk.steps < pass_walk.w);
#ifdef CAPTURE
  write_captured(unfinished);
#endif
  bool complete = write_result(origin_and_end.w);
#if defined(OUT_INVERSE) && !defined(THOROUGH)
  // A ray that drifts cannot be derived again in the middle of an instance: the thorough program starts anew.
#ifdef CAPTURE
  if (!captured.full)
#endif
  if (unfinished) {
    ray = world_ray;
    start();
    start_walk();
  }
#endif
  if (unfinished || !complete) write_unfinished();
  out_0 = result_0, out_1 = result_1, out_2 = result_2;
#ifdef HAS_TRANSFORMS
  out_3 = result_3;
#endif
#if defined(RENDERING) && defined(THOROUGH)
  if (is_kept) {
    out_0 = kept_0, out_1 = kept_1, out_2 = kept_2;
#ifdef HAS_TRANSFORMS
    out_3 = kept_3;
#endif
  }
#endif
}
