// SPDX-License-Identifier: MIT
#include "scenes/json_transform.h"

#include <algorithm>
#include <cmath>

#include "scenes/random.h"

namespace plumbline {
namespace {

/// Cosine and sine of an angle in degrees, exact at multiples of 90: fmod and the subtraction are.
glm::dvec2 cos_sin(double degrees) {
  const double turn = std::fmod(degrees, 360.0), quarters = std::round(turn / 90.0);
  const double rest = glm::radians(turn - 90.0 * quarters), c = std::cos(rest), s = std::sin(rest);
  switch ((static_cast<int>(quarters) % 4 + 4) % 4) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

/// Of unit length; components may be of any size that a float has.
glm::dvec3 unit_axis(const JsonPlace& place) {
  const glm::dvec3 axis = place.vector(), size = glm::abs(axis);
  const double largest = std::max({size.x, size.y, size.z});
  if (!(largest > 0.0)) place.fail("an axis must not be zero");
  return glm::normalize(axis / largest);
}

glm::dquat quaternion_about(const glm::dvec3& unit, double degrees) {
  const glm::dvec2 half = cos_sin(0.5 * degrees);
  return {half.x, half.y * unit.x, half.y * unit.y, half.y * unit.z};
}

struct Rotation {
  glm::dmat3 matrix{1.0};
  glm::dquat quaternion{1.0, 0.0, 0.0, 0.0};
};

Rotation read_rotation(const JsonPlace& place) {
  place.check_object();
  if (const auto quaternion = place.find("quaternion")) {
    place.allow({"quaternion"});
    quaternion->check_array(4, 4);
    double part[4], largest = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      part[i] = quaternion->at(i).number();
      largest = std::max(largest, std::abs(part[i]));
    }
    if (!(largest > 0.0)) quaternion->fail("a quaternion must not be zero");
    const glm::dquat unit = glm::normalize(
        glm::dquat(part[3] / largest, part[0] / largest, part[1] / largest, part[2] / largest));  // w comes first
    return {glm::mat3_cast(unit), unit};
  }
  if (const auto euler = place.find("euler")) {
    place.allow({"euler"});
    const glm::dvec3 degrees = euler->vector();
    Rotation rotation;
    for (glm::length_t i = 0; i < 3; ++i) {
      glm::dvec3 axis(0.0);
      axis[i] = 1.0;
      rotation.matrix = rotation_about(axis, degrees[i]) * rotation.matrix;
      rotation.quaternion = quaternion_about(axis, degrees[i]) * rotation.quaternion;
    }
    return rotation;
  }
  place.allow({"axis", "degrees", "quaternion", "euler"});
  const glm::dvec3 axis = unit_axis(place.need("axis"));
  const double degrees = place.need("degrees").number();
  return {rotation_about(axis, degrees), quaternion_about(axis, degrees)};
}

glm::dvec3 read_scale(const JsonPlace& place) {
  const glm::dvec3 scale = place.is_array() ? place.vector() : glm::dvec3(place.number());
  if (scale.x == 0.0 || scale.y == 0.0 || scale.z == 0.0) place.fail("a scale of 0 makes the matrix singular");
  return scale;
}

glm::dmat3 read_shear(const JsonPlace& place) {
  place.allow({"xy", "xz", "yx", "yz", "zx", "zy"});
  glm::dmat3 matrix(1.0);
  for (glm::length_t row = 0; row < 3; ++row) {
    for (glm::length_t column = 0; column < 3; ++column) {
      const char key[2] = {static_cast<char>('x' + row), static_cast<char>('x' + column)};
      if (const auto amount = place.find(std::string_view(key, 2))) matrix[column][row] = amount->number();
    }
  }
  return matrix;
}

TransformD read_matrix(const JsonPlace& place) {
  if (!place.is_array()) place.fail("expected 3 or 4 rows of 4 numbers");
  place.check_array(3, 4);
  TransformD transform;
  for (std::size_t row = 0; row < place.size(); ++row) {
    const JsonPlace values = place.at(row);
    values.check_array(4, 4);
    for (std::size_t column = 0; column < 4; ++column) {
      const double value = values.at(column).number();
      const auto r = static_cast<glm::length_t>(row), c = static_cast<glm::length_t>(column);
      if (row == 3) {
        if (value != (column == 3 ? 1.0 : 0.0)) values.fail("the last row must be 0 0 0 1");
      } else if (column == 3) {
        transform.translation[r] = value;
      } else {
        transform.linear[c][r] = value;
      }
    }
  }
  return transform;
}

/// One object. `keys` are those of a keyframe where it is one.
FileTransform read_one(const JsonPlace& place) {
  place.check_object();
  FileTransform result;
  if (const auto matrix = place.find("matrix")) {
    place.allow({"matrix"});
    result.matrix = read_matrix(*matrix);
    result.is_simple = false;
    rounded(*matrix, result.matrix);
    return result;
  }
  place.allow({"translate", "rotate", "shear", "scale", "matrix"});
  glm::dmat3 linear(1.0);
  if (const auto scale = place.find("scale")) {
    result.scale = read_scale(*scale);
    for (glm::length_t axis = 0; axis < 3; ++axis) linear[axis] *= result.scale[axis];
  }
  if (const auto shear = place.find("shear")) {
    linear = read_shear(*shear) * linear;
    result.is_simple = false;
    rounded(*shear, {linear, glm::dvec3(0.0)});
  }
  if (const auto rotate = place.find("rotate")) {
    const Rotation rotation = read_rotation(*rotate);
    linear = rotation.matrix * linear;
    result.rotation = rotation.quaternion;
  }
  if (const auto translate = place.find("translate")) result.translation = translate->vector();
  result.matrix = {linear, result.translation};
  return result;
}

/// By how much copies differ at most from one another.
struct Jitter {
  std::uint64_t seed = 0;
  glm::dvec3 translation{0.0};
  glm::dvec3 axis{0.0, 1.0, 0.0};
  double degrees = 0.0;
  double least_scale = 1.0, most_scale = 1.0;
};

Jitter read_jitter(const JsonPlace& place) {
  place.allow({"seed", "translate", "rotate", "scale"});
  Jitter jitter;
  if (const auto seed = place.find("seed")) jitter.seed = seed->integer(0, 0xffffffffu);
  if (const auto translate = place.find("translate")) jitter.translation = translate->vector();
  if (const auto rotate = place.find("rotate")) {
    rotate->allow({"axis", "degrees"});
    jitter.axis = unit_axis(rotate->need("axis"));
    jitter.degrees = rotate->need("degrees").number();
  }
  if (const auto scale = place.find("scale")) {
    scale->check_array(2, 2);
    jitter.least_scale = scale->at(0).number();
    jitter.most_scale = scale->at(1).number();
    if (!(jitter.least_scale > 0.0 && jitter.least_scale <= jitter.most_scale))
      scale->fail("expected the least and the largest factor, both above 0");
  }
  return jitter;
}

TransformD jittered(const Jitter& jitter, std::uint64_t copy) {
  Random random(jitter.seed, name_hash("jitter"), copy);
  glm::dvec3 translation;
  for (glm::length_t i = 0; i < 3; ++i) translation[i] = jitter.translation[i] * random.uniform(-1.0, 1.0);
  const double degrees = jitter.degrees * random.uniform(-1.0, 1.0);
  const double scale = random.uniform(jitter.least_scale, jitter.most_scale);
  return {rotation_about(jitter.axis, degrees) * glm::dmat3(scale), translation};
}

}  // namespace

glm::dmat3 rotation_about(const glm::dvec3& axis, double degrees) {
  // Rodrigues' formula: c I + s [a]x + (1 - c) a a^T.
  const glm::dvec3 a = glm::normalize(axis);
  const glm::dvec2 turn = cos_sin(degrees);
  const double c = turn.x, s = turn.y;
  glm::dmat3 matrix = (1.0 - c) * glm::outerProduct(a, a);
  for (glm::length_t i = 0; i < 3; ++i) matrix[i][i] += c;
  matrix[0][1] += s * a.z;
  matrix[1][0] -= s * a.z;
  matrix[1][2] += s * a.x;
  matrix[2][1] -= s * a.x;
  matrix[2][0] += s * a.y;
  matrix[0][2] -= s * a.y;
  return matrix;
}

FileTransform read_transform(const JsonPlace& place) {
  FileTransform result;
  if (!place.is_array()) {
    if (!place.is_object()) place.fail("expected an object or a list of objects");
    result = read_one(place);
  } else if (place.size() == 1) {
    result = read_one(place.at(0));
  } else {
    for (std::size_t i = 0; i < place.size(); ++i) result.matrix = compose(read_one(place.at(i)).matrix, result.matrix);
    result.is_simple = place.size() == 0;
  }
  rounded(place, result.matrix);
  return result;
}

Transform rounded(const JsonPlace& place, const TransformD& transform) {
  const Transform result{glm::mat3(transform.linear), glm::vec3(transform.translation)};
  const std::string problem = transform_error(result);
  if (!problem.empty()) place.fail("the matrix " + problem + " in 32 bits");
  return result;
}

Animation read_keyframes(const JsonPlace& place, const FileTransform& rest) {
  place.check_array(1);
  if (!rest.is_simple)
    place.fail("a node with keyframes takes its transform as one object of translate, rotate and scale");
  Animation animation;
  animation.rest_translation = rest.translation;
  animation.rest_rotation = rest.rotation;
  animation.rest_scale = rest.scale;
  double last = 0.0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    const JsonPlace key = place.at(i);
    key.allow({"time", "translate", "rotate", "scale"});
    const double time = key.need("time").number();
    if (i > 0 && !(time > last)) key.need("time").fail("the times of keyframes must ascend");
    last = time;
    if (key.size() == 1) key.fail("a keyframe has at least one of translate, rotate and scale");
    if (const auto translate = key.find("translate")) animation.translation.push_back({time, translate->vector()});
    if (const auto rotate = key.find("rotate")) animation.rotation.push_back({time, read_rotation(*rotate).quaternion});
    if (const auto scale = key.find("scale")) {
      const glm::dvec3 value = read_scale(*scale);
      if (!animation.scale.empty()) {
        for (glm::length_t axis = 0; axis < 3; ++axis) {
          if ((animation.scale.back().value[axis] < 0.0) != (value[axis] < 0.0))
            scale->fail("a scale that changes its sign from one keyframe to the next is singular between them");
        }
      }
      animation.scale.push_back({time, value});
    }
  }
  // Between keyframes every component of the scale lies between those at them.
  for (std::size_t i = 0; i < place.size(); ++i) {
    const std::string problem = transform_error(transform_at(animation, place.at(i).need("time").number()));
    if (!problem.empty()) place.at(i).fail("the matrix " + problem + " in 32 bits");
  }
  return animation;
}

std::optional<std::vector<TransformD>> read_copies(const JsonPlace& node, const TransformD& own, std::uint32_t most) {
  const auto repeat = node.find("repeat"), jitter = node.find("jitter");
  if (!repeat) {
    if (jitter) jitter->fail("only copies are jittered; the node has no 'repeat'");
    return std::nullopt;
  }
  if (!repeat->is_array() && !repeat->is_object()) repeat->fail("expected an object of 'count' and 'by', or a list");
  // The copies so far, once for each step of the next repetition.
  std::vector<TransformD> copies{TransformD{}};
  const std::size_t repetitions = repeat->is_array() ? repeat->size() : 1;
  for (std::size_t r = 0; r < repetitions; ++r) {
    const JsonPlace place = repeat->is_array() ? repeat->at(r) : *repeat;
    place.allow({"count", "by"});
    const std::uint32_t count = place.need("count").integer(1, most);
    if (copies.size() * std::uint64_t{count} > most)
      place.fail("the scene has more than " + std::to_string(most) + " nodes");
    const TransformD by = read_transform(place.need("by")).matrix;
    const std::vector<TransformD> before = copies;
    TransformD step;
    for (std::uint32_t i = 1; i < count; ++i) {
      step = compose(by, step);
      for (const TransformD& copy : before) copies.push_back(compose(step, copy));
    }
  }
  Jitter amounts;
  if (jitter) amounts = read_jitter(*jitter);
  for (std::size_t i = 0; i < copies.size(); ++i) {
    TransformD inner = own;
    if (jitter) inner = compose(own, jittered(amounts, i));
    copies[i] = compose(copies[i], inner);
  }
  return copies;
}

}  // namespace plumbline
