// SPDX-License-Identifier: BSD-3-Clause
// On a device, the k nearest points of each part are the host's.
#include "support/brute_nearest.hpp"
#include "support/frames_device.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace nearest_k_test {

using namespace testing;
using clearance::device, clearance::host, clearance::nearest_k, clearance::placed, clearance::point_span;

namespace {

template <class V, class P>
void all_scenes() {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const std::tuple both(placed{all.span, s.cloud_pose}, placed{all.raw, all.camera_pose});
    for (const std::size_t k : {1, 7, 400})
      for (const real d_max : {real(-0.02), real(0.3), clearance::infinity})
        require_same(ask(gpu, there, s.poses, both, nearest_k{k, d_max}),
                     ask(host{}, model, s.poses, both, nearest_k{k, d_max}), v, s.name + ", " + std::to_string(k));
  }
}

}  // namespace

TEST_CASE("On a device the k nearest points of inner spheres are the host's") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("On a device the k nearest points of triangles are the host's") { all_scenes<clearance::aabb, triangle>(); }

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
  verdict v;
  const device gpu;
  for (const int parts : {3, 130}) {
    moving_frames f(parts, 124);
    const auto model = f.model();
    const auto there = model.on(gpu);
    clearance::query query(gpu, there, clearance::nearest_k{});
    for (; f.there(); f.next()) {
      const std::size_t k = f.number < 4 ? 500 : 3;  // what is known of a frame is of use in some, and in some not
      require_same(query(f.s.poses, f.here(), {k}), ask(host{}, model, f.s.poses, f.here(), nearest_k{k}), v,
                   std::to_string(parts) + " parts, frame " + std::to_string(f.number));
      CHECK_THROWS_AS(query(f.s.poses, f.here(), {0}), std::invalid_argument);
    }
  }
}

}  // namespace nearest_k_test
