// SPDX-License-Identifier: BSD-3-Clause
#include "../../tools/demo_scene.hpp"
#include "support/catch.hpp"

#include <map>

namespace demo_scene_test {

TEST_CASE("the demonstration's arm is seven closed parts of about 12,000 triangles, all behind its camera") {
  const demo_scene scene = make_demo_scene(1);
  REQUIRE(scene.parts.size() == 7);
  std::size_t triangles = 0;
  for (const auto& part : scene.parts) {
    INFO(part.name);
    triangles += part.mesh.triangles.size();
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    for (const auto& t : part.mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
      volume += part.mesh.vertices[t[0]].dot(part.mesh.vertices[t[1]].cross(part.mesh.vertices[t[2]])) / 6;
    }
    bool closed = true;
    for (const auto& [edge, count] : edges)
      closed = closed && count == 1 && edges.count({edge.second, edge.first}) == 1;
    CHECK(closed);
    CHECK(volume > 0);
    for (const auto& v : part.mesh.vertices) REQUIRE((scene.world_from_camera.inverse() * (part.pose * v)).z() < 0);
  }
  CHECK(triangles == 12096);
}

TEST_CASE("the demonstration's depth image is the same for the same seed, noisy, and not complete") {
  const demo_scene scene = make_demo_scene(1), again = make_demo_scene(1), other = make_demo_scene(2);
  CHECK(scene.depth == again.depth);
  CHECK(scene.depth != other.depth);
  REQUIRE(scene.depth.size() == std::size_t(640 * 480));
  std::size_t missing = 0;
  double squares = 0, count = 0, least = 1e9;
  for (std::size_t i = 0; i < scene.depth.size(); ++i) {
    if (scene.depth[i] == 0) {
      ++missing;
      continue;
    }
    const double z = scene.depth[i] * 0.001;
    const Eigen::Vector3d ray((double(i % 640) - scene.camera.cx) / scene.camera.fx,
                              (double(i / 640) - scene.camera.cy) / scene.camera.fy, 1);
    demo_hit seen;
    for (const auto& box : scene.boxes)
      if (const auto h = hit(box, scene.world_from_camera.translation(), scene.world_from_camera.linear() * ray);
          h.along < seen.along)
        seen = h;
    const double sigma = 0.0004 + 0.0019 * seen.along * seen.along, rounding = 0.001 / std::sqrt(12.0);
    squares += std::pow(z - seen.along, 2) / (sigma * sigma + rounding * rounding);
    ++count;
    const Eigen::Vector3d in_world = scene.world_from_camera * (z * ray);
    for (const auto& v : scene.parts.back().mesh.vertices)
      if (i % 97 == 0) least = std::min(least, (scene.parts.back().pose * v - in_world).norm());
  }
  CHECK(missing > scene.depth.size() / 100);
  CHECK(missing < scene.depth.size() / 5);
  CHECK(squares / count == Approx(1).margin(0.02));
  CHECK(least > 0.05);
  CHECK(least < 0.20);
}

}  // namespace demo_scene_test
