// SPDX-License-Identifier: BSD-3-Clause
// Clouds in chunks on a device give the host's answer about the whole cloud, in every bit, wherever the points are and
// whatever is skipped.
#include "support/chunked.hpp"
#include "support/product_device.cuh"

#include <clearance/chunked_query.hpp>
#include <clearance/device.cuh>

#include <cstring>

namespace chunked_query_test {

using namespace testing;
using clearance::chunked, clearance::device, clearance::host, clearance::min_distance, clearance::point_span;

TEST_CASE("A cloud in chunks has the answer of the whole on a device: all scenes, points and images") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    chunked points(all.span, 1);
    ask_often(device{}, model, s.poses, points, all.span, s.cloud_pose, v, s.name + ", points");
    chunked image(all.raw, 1);
    ask_often(device{}, model, s.poses, image, all.raw, all.camera_pose, v, s.name + ", image");
  }
}

TEST_CASE("From pageable, pinned and device memory, and from a reader that may fail; chunks that do not divide") {
  verdict v;
  const auto robot = arm();
  for (const std::size_t n : {0, 1, 4095, 4096, 4097, 300001}) {
    const auto cloud = wall(n);
    const point_span pageable(cloud);
    clearance::pinned_buffer<vec3> memory(n, 0);
    std::copy(cloud.begin(), cloud.end(), memory.data());
    const auto there = device{}.copy_in(std::span<const vec3>(cloud));
    int reads = 0, fails_at = -1;
    const auto read = [&](std::size_t offset, std::span<std::byte> to) {
      if (reads++ == fails_at) throw std::runtime_error("the link is down");
      std::memcpy(to.data(), reinterpret_cast<const std::byte*>(cloud.data()) + offset, to.size());
    };
    for (const std::size_t chunk : {1, 20000, 1 << 20}) {
      const std::string what = std::to_string(n) + " in chunks of " + std::to_string(chunk);
      chunked a(pageable, chunk), b(point_span(memory.data(), n), chunk), c(point_span(there.data(), n), chunk);
      chunked e(clearance::read_records(n, sizeof(vec3), read, points_at), chunk);
      ask_often(device{}, robot, arm_poses, a, pageable, shifted(0.1, 0, 0), v, what + ", pageable");
      ask_often(device{}, robot, arm_poses, b, pageable, shifted(0.1, 0, 0), v, what + ", pinned");
      ask_often(device{}, robot, arm_poses, c, pageable, shifted(0.1, 0, 0), v, what + ", on the device");
      ask_often(device{}, robot, arm_poses, e, pageable, shifted(0.1, 0, 0), v, what + ", read");
      if (n < 5000 || chunk > 20000) continue;
      const auto model = robot.on(device{});
      clearance::chunked_query query(device{}, model, min_distance{});
      for (const int k : {0, 5}) {
        e.forget(), reads = 0, fails_at = k;
        CHECK_THROWS_WITH(query(arm_poses, e), "the link is down");
        fails_at = -1;
        v.require(same_result(query(arm_poses, e), ask(host{}, robot, arm_poses, cloud, min_distance{})), what,
                  ": another answer after a failure");
        const std::uint64_t all = query.loaded();
        query(arm_poses, e);
        v.require(all == n && query.loaded() < n / 2, what, ": nothing was skipped");
      }
    }
  }
}

TEST_CASE("Rooms that memory has run out for are there when less is needed") {
  clearance::staging_ring ring(device{});
  CHECK_THROWS_AS(ring.need(1000, std::size_t(1) << 50), clearance::cuda_error);
  ring.need(1000, 1000);
  for (std::size_t k = 0; k < clearance::staging_ring::rooms; ++k) CHECK(ring.fill(k) != nullptr);
}

}  // namespace chunked_query_test
