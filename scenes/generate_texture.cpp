// SPDX-License-Identifier: MIT
#include "scenes/generate_texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/error.h"
#include "scenes/random.h"
#include "scenes/text_file.h"

namespace plumbline {
namespace {

constexpr int kTexelsPerPiece = 16;
constexpr int kMostPieces = 64;

/// The value of texel (x, y) of a texture of n pieces along a side.
using TexelValue = float (*)(int x, int y, int n);

float checker(int x, int y, int) { return (x / kTexelsPerPiece + y / kTexelsPerPiece) % 2 == 0 ? 1.0f : 0.25f; }

float stripes(int x, int, int) { return x / kTexelsPerPiece % 2 == 0 ? 1.0f : 0.0f; }

float waves(int x, int, int) {
  const double phase = 2.0 * 3.141592653589793 * (x + 0.5) / kTexelsPerPiece;
  return static_cast<float>(0.5 - 0.5 * std::cos(phase));
}

float cobbles(int x, int y, int n) {
  const int column = x / kTexelsPerPiece, row = y / kTexelsPerPiece;
  Random random(1, name_hash("cobbles"), static_cast<std::uint64_t>(row * n + column));
  const double height = random.uniform(0.7, 1.0), width = random.uniform(0.85, 0.98);
  const double u = (2.0 * (x % kTexelsPerPiece) + 1.0) / kTexelsPerPiece - 1.0;
  const double v = (2.0 * (y % kTexelsPerPiece) + 1.0) / kTexelsPerPiece - 1.0;
  // A superellipse: a square with round corners whose top is nearly flat.
  const double r = (std::pow(u, 4) + std::pow(v, 4)) / std::pow(width, 4);
  return static_cast<float>(r < 1.0 ? height * std::sqrt(1.0 - r) : 0.0);
}

/// A wall in running bond: bricks of two pieces by one, with joints between them; each brick has a shade of its own.
float bricks(int x, int y, int n) {
  const int row = y / kTexelsPerPiece, shifted = (x + row % 2 * kTexelsPerPiece) % (n * kTexelsPerPiece);
  const int brick = shifted / (2 * kTexelsPerPiece);
  Random random(1, name_hash("bricks"), static_cast<std::uint64_t>(row * n + brick));
  const double shade = random.uniform(0.72, 1.0);
  const double across = shifted % (2 * kTexelsPerPiece) + 0.5, up = y % kTexelsPerPiece + 0.5;
  const double to_edge = std::min({across, 2.0 * kTexelsPerPiece - across, up, kTexelsPerPiece - up});  // texels
  constexpr double kJoint = 1.0, kRounded = 2.5, kDepth = 0.4;
  return static_cast<float>(shade * (1.0 - kDepth * (1.0 - std::clamp((to_edge - kJoint) / kRounded, 0.0, 1.0))));
}

struct Kind {
  std::string_view name;
  bool needs_even;  ///< an odd number of pieces would leave a seam
  TexelValue value;
};
constexpr std::array<Kind, 5> kKinds = {{{"checker", true, checker},
                                         {"stripes", true, stripes},
                                         {"waves", false, waves},
                                         {"cobbles", false, cobbles},
                                         {"bricks", true, bricks}}};

const Kind* find_kind(std::string_view name) {
  const std::string_view stem = name.substr(0, name.find(':'));
  const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& kind) { return kind.name == stem; });
  return found == kKinds.end() ? nullptr : &*found;
}

}  // namespace

bool is_generated_texture(std::string_view name) { return find_kind(name) != nullptr; }

Texture generate_texture(std::string_view name) {
  const Kind* const kind = find_kind(name);
  PLUMBLINE_ASSERT(kind != nullptr);
  int pieces = 8;
  if (const std::size_t colon = name.find(':'); colon != name.npos) {
    const auto number = parse_integer(name.substr(colon + 1));
    if (!number || *number < 1 || *number > kMostPieces || (kind->needs_even && *number % 2 != 0)) {
      throw InputError(shown(name) + ": the number must be " + (kind->needs_even ? "even, " : "whole, ") +
                       "from 1 to " + std::to_string(kMostPieces) + ", as in \"" + std::string(kind->name) + ":8\"");
    }
    pieces = static_cast<int>(*number);
  }
  Texture texture;
  texture.path = std::string(kind->name) + ":" + std::to_string(pieces);
  texture.width = texture.height = pieces * kTexelsPerPiece;
  for (int y = 0; y < texture.height; ++y)
    for (int x = 0; x < texture.width; ++x) texture.texels.emplace_back(kind->value(x, y, pieces));
  return texture;
}

}  // namespace plumbline
