// SPDX-License-Identifier: GPL-3.0-or-later
// Inspects one geometry image: takes it apart, traces rays through it, paints its pictures, and records all of that.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "reports/inspect_record.h"
#include "scenes/camera.h"
#include "tracer/gl_context.h"
#include "tracer/inspect.h"
#include "tracer/inspect_figures.h"
#include "tracer/inspect_rays.h"

namespace plumbline {

/// What is to be inspected, and with which rays.
struct InspectTask {
  std::string name, source;  ///< as in InspectedBake
  std::string stem;          ///< of picture files
  const GeometryImage* image = nullptr;
  const Scene* scene = nullptr;  ///< for the names of nodes; null: not known
  std::string spec;              ///< what loads the scene, for commands that replay; empty: not known
  double bake_seconds = 0.0;
  Camera camera;                ///< of the camera's rays
  std::size_t lines = 1 << 16;  ///< random lines
  std::uint64_t seed = 1;
  std::size_t top = 5;  ///< costliest nodes and longest walks that are listed
  std::filesystem::path out;
  std::function<void(double share, const std::string& what)> progress;
};

/// An image taken apart, with its record.
struct Inspection {
  InspectedImage inspected;
  std::vector<NodeLoad> loads;  ///< of each node
  InspectedBake record;         ///< complete but for `outline` and the costliest nodes: see list_nodes
};

Inspection inspect(GlContext& context, const InspectTask& task);

/// Of each node of `a` its twin in `b`: the one above the same primitives and transforms. Empty where the two are not
/// alike: the same trees in the same regions, whatever the order of children.
std::vector<std::uint32_t> twins_between(const InspectedImage& a, const InspectedImage& b);

/// Fills the outline (all nodes, or the upper levels of at most kMostOutlined) and the `top` costliest nodes. `other`
/// and `twins` tell what the nodes of another image have cost; empty: none.
void list_nodes(const GeometryImage& image, std::size_t top, const std::vector<std::uint32_t>& twins,
                const std::vector<NodeLoad>& other, Inspection& inspection);
inline constexpr std::size_t kMostOutlined = 40'000;

}  // namespace plumbline
