// SPDX-License-Identifier: MIT
// What shading needs beside the geometry image: corners, normals and texture coordinates of primitives, materials,
// textures and composed transforms, as texels of four floats that shaders fetch by number. This header is the only
// place where the format is written down; its constants reach the GLSL from here.
//
//   material m     M0  colour, Kd                M1  Ks, shine, T, index of refraction
//                  M2  diffuse texture + 1 or 0, bump texture + 1 or 0, bump scale, glossy (below 0: the scene's)
//   texture t      X0  where its texels start: high * kTextureBlock + low (both exact); width, height
//   instance n     six texels: the rows of the linear part L, each with a component of the translation T; the rows of
//                  L^-1. Composed of all nodes from n outwards, world units
//   ground         G0  centre, radius   G1  normal, texture size   G2  u axis, material   G3  v axis, 0
//   triangle k     T0  corner 0, material   T1  corner 1, 1 where it has normals   T2  corner 2, 1 where it has texture
//                  coordinates   T3 T4 T5  normals, of unit length; in w: u0, v0, u1   T6  v1, u2, v2, 0
//   sphere s       S0  centre, radius   S1  material, 0, 0, 0
//
// They stand in this order: ground, materials, textures, triangles, spheres, instances. Texels of textures are an image
// of their own: linear colours, w = 0, texture by texture, row 0 at the top.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace plumbline {

inline constexpr std::uint32_t kGroundTexels = 4, kMaterialTexels = 3, kInstanceTexels = 6,
                               kShadingTriangleTexels = 7, kShadingSphereTexels = 2;
inline constexpr std::uint32_t kTextureBlock = 4096;

struct ShadingImage {
  std::vector<glm::vec4> texels;          ///< all but the textures
  std::vector<glm::vec4> texture_texels;  ///< at least one
  std::uint32_t material_start = 0, texture_start = 0, triangle_start = 0, sphere_start = 0, instance_start = 0;
};

/// Throws InputError for a scene of more texels than an index can tell (2^30).
ShadingImage shading_image(const Scene& scene);

/// The texels of all instances, from instance_start on, for the scene's transforms as they are.
std::vector<glm::vec4> instance_texels(const Scene& scene);

}  // namespace plumbline
