// SPDX-License-Identifier: BSD-3-Clause
// On a device, the k nearest points of each part are those of a plain loop, and of crowds and of images the host's.
#include "support/brute_nearest.hpp"
#include "support/frames_device.cuh"

#include <clearance/device.cuh>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace nearest_k_test {

using namespace testing;
using clearance::device, clearance::host, clearance::nearest_k, clearance::point_span;

TEST_CASE("On a device the k nearest points of inner spheres are the first of all, in order") {
  nearest_k_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, device{});
  like_the_host_beside_images<clearance::sphere, inner_sphere>(cases, device{});
}
TEST_CASE("On a device the k nearest points of triangles are the first of all, in order") {
  nearest_k_cases cases;
  hold_in_all_scenes<clearance::aabb, triangle>(cases, device{});
  like_the_host_beside_images<clearance::aabb, triangle>(cases, device{});
}

TEST_CASE("The nearest of a crowd, and of a shell where all are about equally near") {
  verdict v;
  const device gpu;
  const auto s = crowd(42);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  dice d(43);
  std::vector<vec3> shell;
  for (int i = 0; i < 300000; ++i) shell.push_back(clearance::scaled(3 + 1e-4f * d.number(0, 1), d.direction()));
  for (const std::vector<vec3>* points : {&s.points, &std::as_const(shell)})
    for (const std::size_t k : {1, 100, 5000})
      require_same(ask(gpu, model.on(gpu), s.poses, point_span(*points), nearest_k{k}),
                   ask(host{}, model, s.poses, point_span(*points), nearest_k{k}), v, std::to_string(k));
}

TEST_CASE("Prepared, the nearest are on a device in every frame the host's") {
  nearest_k_cases cases;
  hold_in_every_frame_on_a_device(cases, 124);
}

}  // namespace nearest_k_test
