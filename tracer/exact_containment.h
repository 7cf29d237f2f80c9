// SPDX-License-Identifier: MIT
// Whether balls and boxes contain points and balls, decided exactly: floats are taken as the numbers they are.
#pragma once

#include <glm/glm.hpp>

namespace plumbline {

// A ball is given by its centre and its squared radius, which is a float or the product of two floats, so exact in
// double. All arguments are finite; a squared radius below 0 contains nothing.

/// |point - center|^2 <= radius2.
bool ball_holds_point(const glm::vec3& center, double radius2, const glm::vec3& point);

/// |inner - center| + inner_radius <= sqrt(radius2); inner_radius >= 0.
bool ball_holds_ball(const glm::vec3& center, double radius2, const glm::vec3& inner, float inner_radius);

/// Every point within `inner_radius` of `inner` lies in the box, whose sides belong to it.
bool box_holds_ball(const glm::vec3& lower, const glm::vec3& upper, const glm::vec3& inner, float inner_radius);

}  // namespace plumbline
