// SPDX-License-Identifier: BSD-3-Clause
// Clouds in chunks on a device: the host's answer about the whole, in every bit, wherever the points are and whatever is skipped.
#include "support/product_device.cuh"

#include <clearance/chunked_query.cuh>
#include <clearance/make_model.hpp>
#include <clearance/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstring>

using namespace testing;
using clearance::chunked, clearance::device, clearance::host, clearance::min_distance, clearance::part_minimum, clearance::placed,
    clearance::point_span;

namespace {

bool same_minimum(const part_minimum& a, const part_minimum& b) {
  return same_bits(a.distance, b.distance) && a.cloud == b.cloud && a.point == b.point && a.primitive == b.primitive;
}

/// `source` is the same points in host memory.
template <class Model, class C, class S>
void ask_often(const Model& on_host, std::vector<Eigen::Isometry3d> poses, chunked<C>& cloud, const S& source, const Eigen::Isometry3d& pose, verdict& v,
               const std::string& what) {
  const auto model = on_host.on(device{});
  clearance::chunked_query query(device{}, model);
  std::vector<part_minimum> minima(poses.size());
  for (int round = 0; round < 4; ++round) {
    const placed whole{source, pose};
    v.require(same_result(query(poses, cloud, pose), min_distance(host{}, on_host, poses, whole)), what, ", round ", round, ": another answer");
    const auto [robot, each] = clearance::min_distance_per_part(host{}, on_host, poses, whole);
    v.require(same_result(query.per_part(poses, cloud, pose, minima), robot), what, ", round ", round, ": another answer by parts");
    v.require(std::ranges::equal(minima, each, same_minimum), what, ", round ", round, ": some part's minimum differs");
    poses[0].translation().x() += round == 1 ? 3 : 0.02;
  }
}

std::vector<vec3> wall(std::size_t points) {
  dice d(5);
  std::vector<vec3> all;
  for (std::size_t i = 0; i < points; ++i) all.push_back({real(double(i) * 20 / double(points) - 10), d.number(-1, 1), d.number(1, 2)});
  for (std::size_t i = 7; i < points; i += 1001) all[i].y = clearance::not_a_number;
  return all;
}

}  // namespace

TEST_CASE("A cloud in chunks has the answer of the whole on a device: all scenes, points and images") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    chunked points(all.span, 1);
    ask_often(model, s.poses, points, all.span, s.cloud_pose, v, s.name + ", points");
    chunked image(all.raw, 1);
    ask_often(model, s.poses, image, all.raw, all.camera_pose, v, s.name + ", image");
  }
}

TEST_CASE("From pageable, pinned and device memory, and from a reader that may fail; chunks that do not divide") {
  verdict v;
  dice d(3);
  const auto robot = clearance::make_model<clearance::sphere>(
      std::vector{random_primitives<inner_sphere>(d, 50, 0.3, 0.1), random_primitives<inner_sphere>(d, 30, 0.2, 0.1)});
  const std::vector<Eigen::Isometry3d> poses = {shifted(0, 0, 0), shifted(0.5, 0, 0)};
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
    const auto view = [](const std::byte* bytes, std::size_t count) { return point_span(reinterpret_cast<const vec3*>(bytes), count); };
    for (const std::size_t chunk : {1, 20000, 1 << 20}) {
      const std::string what = std::to_string(n) + " in chunks of " + std::to_string(chunk);
      chunked a(pageable, chunk), b(point_span(memory.data(), n), chunk), c(point_span(there.data(), n), chunk);
      chunked e(clearance::read_records(n, sizeof(vec3), read, view), chunk);
      ask_often(robot, poses, a, pageable, shifted(0.1, 0, 0), v, what + ", pageable");
      ask_often(robot, poses, b, pageable, shifted(0.1, 0, 0), v, what + ", pinned");
      ask_often(robot, poses, c, pageable, shifted(0.1, 0, 0), v, what + ", on the device");
      ask_often(robot, poses, e, pageable, shifted(0.1, 0, 0), v, what + ", read");
      if (n < 5000 || chunk > 20000) continue;
      const auto model = robot.on(device{});
      clearance::chunked_query query(device{}, model);
      for (const int k : {0, 5}) {
        e.forget(), reads = 0, fails_at = k;
        CHECK_THROWS_WITH(query(poses, e), "the link is down");
        fails_at = -1;
        v.require(same_result(query(poses, e), min_distance(host{}, robot, poses, cloud)), what, ": another answer after a failure");
        const std::uint64_t all = query.loaded();
        query(poses, e);
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
