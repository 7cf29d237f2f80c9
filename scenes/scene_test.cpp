// SPDX-License-Identifier: MIT
// Balls around scenes, cameras that frame them, and the rays of cameras against SPD's published counts.
#include <catch2/catch.hpp>
#include <cmath>

#include "scenes/camera.h"
#include "scenes/error.h"
#include "scenes/generate.h"
#include "scenes/ulp.h"

using namespace plumbline;

TEST_CASE("The bounding ball contains every corner and sphere, and is no larger than the box's") {
  for (const char* spec : {"sphereflake:3", "mount:3", "creature", "gears:2", "cube"}) {
    INFO(spec);
    const Scene scene = load_scene(spec);
    const Ball ball = bounding_ball(scene);
    double farthest = 0.0;
    for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
      for (const glm::vec3& corner : scene.corners(t))
        farthest = std::max(farthest, glm::length(glm::dvec3(corner) - ball.center));
    }
    for (const Sphere& sphere : scene.spheres) {
      farthest =
          std::max(farthest, glm::length(glm::dvec3(sphere.center) - ball.center) + static_cast<double>(sphere.radius));
    }
    CHECK(farthest <= ball.radius);
    CHECK(ball.radius <= farthest * (1.0 + 0x1p-48));
  }
  CHECK(bounding_ball(Scene{}).radius == 0.0);
  CHECK(bounding_ball(generate_scene("cube")).radius == Approx(std::sqrt(3.0)));
}

TEST_CASE("frame_camera shows the ball from edge to edge") {
  Scene scene = generate_scene("sphereflake", 1);
  frame_camera(scene);
  const Ball ball = bounding_ball(scene);
  const CameraFrame frame = camera_frame(scene.camera);
  CHECK(scene.camera.width == 512);
  // The ray through the middle of the top row touches the ball.
  const Ray ray = camera_ray(frame, frame.centre_x, 0.0);
  const glm::dvec3 towards = ball.center - glm::dvec3(ray.origin);
  const double along = glm::dot(towards, glm::dvec3(ray.direction));
  CHECK(std::sqrt(glm::dot(towards, towards) - along * along) == Approx(ball.radius).epsilon(1e-4));
}

TEST_CASE("Camera rays: angle spans the centres of the outermost rows, x goes right, y goes down") {
  Camera camera;
  camera.from = {0, 0, 5};
  camera.at = {0, 0, 0};
  camera.up = {0.3f, 1, 7};  // made perpendicular: up is a half plane
  camera.angle_radians = 1.0f;
  camera.width = 101;
  camera.height = 51;
  const auto slope = [&](double x, double y) {
    const Ray ray = camera_ray(camera, x, y);
    CHECK(glm::length(glm::dvec3(ray.direction)) == Approx(1.0).epsilon(1e-7));
    CHECK(ray.origin == camera.from);
    const CameraFrame frame = camera_frame(camera);
    const glm::dvec3 d(ray.direction);
    return glm::dvec2(glm::dot(d, frame.right), glm::dot(d, frame.up)) / glm::dot(d, frame.forward);
  };
  const double edge = std::tan(0.5);
  CHECK(slope(50, 0).y == Approx(edge).epsilon(1e-6));
  CHECK(slope(50, 50).y == Approx(-edge).epsilon(1e-6));
  CHECK(slope(50, 25).y == Approx(0.0).margin(1e-7));
  CHECK(slope(0, 25).x == Approx(-2.0 * edge).epsilon(1e-6));  // pixels are square
  CHECK(slope(100, 25).x == Approx(2.0 * edge).epsilon(1e-6));
  camera.up = {0, 1, 0};
  CHECK(camera_frame(camera).right == glm::dvec3(1, 0, 0));
  camera.height = 1;
  CHECK(std::isfinite(slope(0, 0).x));
  CHECK(slope(50, 0).y == Approx(0.0).margin(1e-7));
}

TEST_CASE("A camera without a view is refused") {
  Camera camera;
  camera.at = camera.from;
  CHECK_THROWS_AS(camera_frame(camera), InputError);
  camera = Camera{};
  camera.up = {0, 0, 3};
  CHECK_THROWS_AS(camera_frame(camera), InputError);
  camera.up = {0, 0, 0};
  CHECK_THROWS_AS(camera_frame(camera), InputError);
  camera.up = {0, 1e-30f, 0};
  CHECK_NOTHROW(camera_frame(camera));
}

TEST_CASE("Steps of units in the last place cross zero and stop at the largest floats") {
  CHECK(step_ulps(1.0f, 1) == std::nextafter(1.0f, 2.0f));
  CHECK(step_ulps(1.0f, -1) == std::nextafter(1.0f, 0.0f));
  CHECK(step_ulps(-1.0f, 1) == std::nextafter(-1.0f, 0.0f));
  CHECK(step_ulps(0.0f, 1) == std::numeric_limits<float>::denorm_min());
  CHECK(step_ulps(-0.0f, -1) == -std::numeric_limits<float>::denorm_min());
  CHECK(step_ulps(std::numeric_limits<float>::denorm_min(), -2) == -std::numeric_limits<float>::denorm_min());
  CHECK(step_ulps(std::numeric_limits<float>::max(), 5) == std::numeric_limits<float>::max());
  CHECK(step_ulps(-std::numeric_limits<float>::max(), -5) == -std::numeric_limits<float>::max());
  CHECK(ulp(1.0f) == 0x1p-23);
  CHECK(ulp(glm::vec3(0.1f, -3.0f, 1.0f)) == 0x1p-22);
}
