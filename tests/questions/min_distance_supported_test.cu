// SPDX-License-Identifier: BSD-3-Clause
// On a device, the nearest point that others confirm is the host's.
#include "support/brute_support.hpp"
#include "support/frames_device.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/volume/sphere.hpp>

namespace min_distance_supported_test {

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance_supported, clearance::placed;

TEST_CASE("On a device the nearest point that others confirm is the host's") {
  verdict v;
  const device gpu;
  std::size_t isolated = 0;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const std::tuple both(placed{all.span, s.cloud_pose}, placed{all.raw, all.camera_pose});
    for (const std::uint32_t min_points : {1, 4})
      for (const double radius : {0.0, 0.1}) {
        const clearance::min_distance_supported options{.min_points = min_points, .radius = radius * s.size};
        const auto a = ask(gpu, there, s.poses, both, options), b = ask(host{}, model, s.poses, both, options);
        require_same(a, b, v, s.name + ", " + std::to_string(min_points) + " within " + std::to_string(options.radius));
        v.require(a.state == b.state && same_bits(a.lower, b.lower) && a.counts.valid == b.counts.valid, s.name,
                  ": state, bracket or counts");
        isolated += a.isolated;
      }
  }
  CHECK(isolated > 100);
}

TEST_CASE("Prepared, the nearest confirmed point is on a device in every frame the host's") {
  verdict v;
  const device gpu;
  for (const int parts : {3, 130}) {
    moving_frames f(parts, 125);
    const auto model = f.model();
    const auto there = model.on(gpu);
    clearance::query query(gpu, there, clearance::min_distance_supported{});
    for (; f.there(); f.next()) {
      const clearance::min_distance_supported options{.min_points = f.number % 2 ? 2u : 3u, .radius = 0.1};
      require_same(query(f.s.poses, f.here(), options), ask(host{}, model, f.s.poses, f.here(), options), v,
                   std::to_string(parts) + " parts, frame " + std::to_string(f.number));
      CHECK_THROWS_AS(query(f.s.poses, f.here(), {.min_points = 0}), std::invalid_argument);
    }
  }
}

}  // namespace min_distance_supported_test
