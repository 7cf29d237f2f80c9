// SPDX-License-Identifier: MIT
// Numbers that C++ and the production GLSL share beside the geometry image's format: they reach the GLSL as #defines.
#pragma once

#include <cstdint>

namespace plumbline {

/// A triangle whose projected area is below this share of its squared extent is resolved exactly (triangle.glsl);
/// bake.h pads for what rounding does above it.
inline constexpr double kEdgeOn = 0x1p-8;
/// A triangle whose doubled projected area is below this is missed: products that were flushed to zero may be all of
/// it. (0x1p-50 image units squared, where the scene's radius is at least 0x1p-20.)
inline constexpr double kLeastDet = 0x1p-100;

/// Rays of one pass: a picture of this size. Small enough that rays and results stay near the cores, large enough that
/// the driver's threads are busy.
inline constexpr int kBatchWidth = 512, kBatchHeight = 512;

/// Far rays are moved near the scene in units of 2^8, so that nothing overflows (ray_prepare.glsl).
inline constexpr int kShiftExponent = 8;

/// Greater than any label of a primitive: nothing is hit yet.
inline constexpr double kNoLabel = 33554432.0;

/// The kind of a result, in the low three bits of its first word; the primitive's number stands above.
inline constexpr std::uint32_t kWordMiss = 0, kWordHit = 1, kWordUndefined = 2, kWordCapped = 3;
inline constexpr std::uint32_t kWordUnfinished = 4;  ///< the words hold the state of a walk that must go on
/// What a resumed pass may read in its place: a ray that a bundle has brought to its end, and one that it has left to
/// begin anew.
inline constexpr std::uint32_t kStateEnded = 1, kStateNew = 0;

/// Random numbers are drawn in blocks of four (shaders/random.glsl): for the place in the pixel, the lens, the normal
/// of a reflection, and each light.
inline constexpr std::uint32_t kBlockPixel = 0, kBlockLens = 1, kBlockNormal = 2, kBlockLights = 3;

/// Texels in a row of the shading image where it is not linear.
inline constexpr int kShadingWidth = 4096;

/// Rays of the largest bundle: each needs two targets. Drivers of desktops have eight; GLSL ES 3.00 promises four, so
/// there bundles of 3 and 4, and capturing passes, need a driver whose MAX_DRAW_BUFFERS allows them.
inline constexpr int kMostBundled = 4;
/// Results take three or four targets a ray: bundles of this size write theirs, larger ones leave what they have found to
/// another pass.
inline constexpr int kBundleWithResults = 2;

/// Of a capturing pass (walk_trace.h): its pixels, all but the last of which keep an event, and the event's kind in the
/// low three bits of its first word.
inline constexpr int kCaptureWidth = 512, kCaptureHeight = 2;
inline constexpr int kCapturePixels = kCaptureWidth * kCaptureHeight;
inline constexpr std::uint32_t kCaptureRay = 1, kCaptureNode = 2, kCapturePrimitive = 3, kCaptureEdgeOn = 4,
                               kCaptureEnter = 5, kCaptureLeave = 6;
inline constexpr std::uint32_t kCaptureHit = 8, kCaptureMisses = 8;  ///< flags beside it
inline constexpr std::uint32_t kCapturePending = 16, kCaptureAccepted = 32, kCaptureSphere = 64;
inline constexpr int kCaptureGoesOn = 2;  ///< where 1 stands for a resumed walk: one whose pass was full of events

}  // namespace plumbline
