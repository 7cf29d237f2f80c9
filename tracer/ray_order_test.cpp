// SPDX-License-Identifier: MIT
// Orders put every ray on a pixel of its own, bring similar rays together, and are chosen where they do.
#include "tracer/ray_order.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "scenes/random.h"
#include "tracer/shader_words.h"

using namespace plumbline;

namespace {

const Ball kBall{{1.0, 2.0, 3.0}, 2.0};

std::vector<Ray> chords(std::size_t count) {
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    Random random(5, 1, i);
    const glm::dvec3 a = kBall.center + kBall.radius * random.direction(),
                     b = kBall.center + kBall.radius * random.direction();
    rays[i].origin = glm::vec3(a), rays[i].direction = glm::vec3(b - a);
  }
  return rays;
}

/// Rays through the pixels of a picture, row by row, or in tiles of 8 x 8 that are far from one another.
std::vector<Ray> picture(int width, int height, bool in_tiles) {
  std::vector<Ray> rays;
  for (int i = 0; i < width * height; ++i) {
    const int tiles_per_row = width / 8, tiles = tiles_per_row * (height / 8), tile = i / 64 * 997 % tiles;
    const int x = in_tiles ? tile % tiles_per_row * 8 + i % 8 : i % width;
    const int y = in_tiles ? tile / tiles_per_row * 8 + i / 8 % 8 : i / width;
    Ray ray;
    ray.origin = glm::vec3(kBall.center) - glm::vec3(0.0f, 0.0f, 6.0f);
    ray.direction = {(static_cast<float>(x) / static_cast<float>(width) - 0.5f) * 0.7f,
                     (static_cast<float>(y) / static_cast<float>(height) - 0.5f) * 0.7f, 1.0f};
    rays.push_back(ray);
  }
  return rays;
}

/// The mean angle between a ray and the one beside it in its group of 4 x 2 pixels.
double mean_angle(const std::vector<Ray>& rays, RayOrder order) {
  const RayPlaces places = place_rays(rays, order, kBall);
  std::vector<std::uint32_t> at(static_cast<std::size_t>(places.rows) * kBatchWidth, kNone);
  for (std::size_t i = 0; i < rays.size(); ++i) at[places.pixel[i]] = static_cast<std::uint32_t>(i);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t p = 0; p + kBatchWidth < at.size(); ++p) {
    for (const std::size_t q : {p + 1, p + kBatchWidth}) {
      const bool same_group = p % kBatchWidth / 4 == q % kBatchWidth / 4 && p / kBatchWidth / 2 == q / kBatchWidth / 2;
      if (!same_group || at[p] == kNone || at[q] == kNone) continue;
      const glm::dvec3 a = glm::normalize(glm::dvec3(rays[at[p]].direction)),
                       b = glm::normalize(glm::dvec3(rays[at[q]].direction));
      sum += std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

}  // namespace

TEST_CASE("every order gives each ray a pixel of its own", "[order]") {
  for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{513}, std::size_t{5000},
                                  std::size_t{kBatchWidth} * kBatchHeight}) {
    const auto rays = chords(count);
    for (const RayOrder order : {RayOrder::picture, RayOrder::groups, RayOrder::sorted}) {
      const RayPlaces places = place_rays(rays, order, kBall);
      REQUIRE(places.pixel.size() == count);
      const std::set<std::uint32_t> different(places.pixel.begin(), places.pixel.end());
      CHECK(different.size() == count);
      CHECK(*different.rbegin() < static_cast<std::uint32_t>(places.rows) * kBatchWidth);
      CHECK(places.rows <= kBatchHeight);
      // The caller clears the last four rows alone: the pixels before them must all be taken.
      const std::size_t full = static_cast<std::size_t>(std::max(places.rows - 4, 0)) * kBatchWidth;
      CHECK(static_cast<std::size_t>(
                std::distance(different.begin(), different.lower_bound(static_cast<std::uint32_t>(full)))) == full);
    }
  }
}

TEST_CASE("sorting brings random rays together", "[order]") {
  const auto rays = chords(100'000);
  CHECK(mean_angle(rays, RayOrder::groups) > 1.0);
  CHECK(mean_angle(rays, RayOrder::sorted) < 0.35);
}

TEST_CASE("the order that suits the rays is chosen", "[order]") {
  CHECK(choose_ray_order(chords(10'000), kBall) == RayOrder::sorted);
  CHECK(choose_ray_order(picture(512, 512, false), kBall) == RayOrder::picture);
  CHECK(choose_ray_order(picture(640, 400, false), kBall) == RayOrder::groups);
  CHECK(choose_ray_order(picture(512, 512, true), kBall) == RayOrder::groups);
}

TEST_CASE("rays that are no rays do not disturb the order", "[order]") {
  auto rays = chords(1000);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < rays.size(); i += 3) {
    rays[i].direction = i % 2 == 0 ? glm::vec3(kNan) : glm::vec3(0.0f);
    rays[i].origin.x = i % 5 == 0 ? kInfinity : 3e38f;
  }
  const RayPlaces places = place_rays(rays, choose_ray_order(rays, kBall), kBall);
  CHECK(std::set<std::uint32_t>(places.pixel.begin(), places.pixel.end()).size() == rays.size());
  CHECK(choose_ray_order({}, kBall) == RayOrder::groups);
  CHECK(choose_ray_order(rays, Ball{}) == RayOrder::groups);
}
