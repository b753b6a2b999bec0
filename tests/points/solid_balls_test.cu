// SPDX-License-Identifier: BSD-3-Clause
// On a device full balls have the host's answers, wherever they lie: in host memory, in Thrust's vectors, in chunks.
#include "points/solid_balls_scenes.hpp"
#include "questions/uncertain_forms.hpp"

#include <clearance/device.cuh>
#include <clearance/points/solid_balls.hpp>

#include <thrust/device_vector.h>
#include <thrust/host_vector.h>
#include <thrust/universal_vector.h>

namespace solid_balls_device_test {

using namespace testing;
using clearance::balls_of, clearance::chunked, clearance::device, clearance::devices, clearance::host,
    clearance::in_device_memory, clearance::placed;

namespace {

template <class C>
concept balls_in = requires(C&& c) { balls_of(static_cast<C&&>(c)); };
static_assert(balls_in<thrust::device_vector<float4>&> && !balls_in<thrust::device_vector<float4>>);
static_assert(balls_in<thrust::host_vector<float4>&> && !balls_in<thrust::device_vector<float3>&>);
using there = decltype(balls_of(std::declval<const thrust::device_vector<float4>&>()));
static_assert(there::only_on_device && clearance::ball_source<there> && !clearance::vague_source<there>);
static_assert(
    std::string_view(clearance::why_not<clearance::min_distance, there>()).starts_with("these points are in a device"));

struct given {
  dice d{47};
  device gpu;
  decltype(arm()) on_host = arm();
  decltype(on_host.on(gpu)) robot = on_host.on(gpu);
  Eigen::Isometry3d pose = shifted(0.1, 0, 0);

  /// Asks about the same balls in other memory, cold and warm.
  template <class Q, class Here, class There>
  void compare(verdict& v, const std::vector<Eigen::Isometry3d>& poses, const Q& q, const Here& here,
               const There& other, const std::string& what) const {
    const typename Q::result expected = ask(host{}, on_host, poses, here, pose, q);
    clearance::query prepared(gpu, robot, q);
    for (const char* time : {"cold", "warm"})
      v.require(same_answer(expected, typename Q::result(prepared(poses, placed{other, pose}))), what, ", ", time);
  }
};

}  // namespace

TEST_CASE("Full balls in Thrust's vectors and in the host's memory are as near as on the host") {
  verdict v;
  const given g;
  for (const std::size_t n : {1, 4097, 60000}) {
    dice d(unsigned(n) + 1);
    const auto points = wall(n);
    const auto radii = ball_radii_of(d, n, 0.4);
    thrust::host_vector<float4> records;
    for (std::size_t i = 0; i < n; ++i) records.push_back({points[i].x, points[i].y, points[i].z, radii[i]});
    const thrust::device_vector<float4> in_device = records;
    const thrust::universal_vector<float4> anywhere = records;
    const thrust::device_vector<real> its_radii(radii.begin(), radii.end());
    const thrust::host_vector<vec3> centres(points.begin(), points.end());
    const thrust::device_vector<vec3> its_centres = centres;
    const auto here = balls_of(points, radii, 0.01);
    const auto each = [&](const char* name, const auto& q, const auto& poses) {
      const std::string what = std::string(name) + ", " + std::to_string(n);
      g.compare(v, poses, q, here, here, what + ", in the host's memory");
      g.compare(v, poses, q, here, balls_of(in_device, 0.01), what + ", records on the device");
    };
    each("min_distance", clearance::min_distance{}, arm_poses);
    each("min_distance_per_part", clearance::min_distance_per_part{}, arm_poses);
    each("certain_distance", clearance::certain_distance{}, arm_poses);
    each("zones", clearance::zones{.thresholds = {0.1, 0.4}, .radii = {0.02, 0.01}}, arm_poses);
    each("in_collision", clearance::in_collision{{0.05}}, arm_poses);
    std::vector<Eigen::Isometry3d> many = arm_poses;
    for (const auto& pose : arm_poses) many.push_back(shifted(0.3, -0.1, 0) * pose);
    each("min_distances", clearance::min_distances{}, many);
    each("in_collisions", clearance::in_collisions{{0.05}}, many);
    const clearance::min_distance q;
    g.compare(v, arm_poses, q, here, balls_of(records, 0.01), "a host_vector of float4");
    g.compare(v, arm_poses, q, here, balls_of(anywhere, 0.01), "a universal_vector of float4");
    g.compare(v, arm_poses, q, here, balls_of(its_centres, its_radii, 0.01), "centres and radii on the device");
    clearance::chunked_query by_chunks(g.gpu, g.robot, q);
    const auto one_memory = balls_of(records, 0.01);
    chunked chunks(one_memory, 8192);
    chunked on_device(balls_of(in_device, 0.01), 1);
    const auto expected = ask(host{}, g.on_host, arm_poses, here, g.pose, q);
    for (int round = 0; round < 2; ++round) {
      v.require(same_answer(expected, by_chunks(arm_poses, chunks, g.pose)), "chunks of the host's memory, ", n);
      v.require(same_answer(expected, by_chunks(arm_poses, on_device, g.pose)), "chunks of the device's memory, ", n);
    }
    const devices two{0, 0};
    v.require(same_answer(expected, ask(two, g.on_host.on(two), arm_poses, placed{here, g.pose}, q)), "two devices, ",
              n);
  }
}

TEST_CASE("With poses in the device's memory the gap of balls is in the bracket, too") {
  const given g;
  const std::vector<float4> records{{0, 0, 1.5f, 0.25f}, {0, 0, 3, 0.5f}};
  const thrust::device_vector<float4> balls(records.begin(), records.end());
  std::vector<clearance::world_transform> poses;
  for (const auto& pose : arm_poses) poses.emplace_back(pose);
  const thrust::device_vector<clearance::world_transform> its_poses(poses.begin(), poses.end());
  thrust::device_vector<clearance::min_distance_result> result(1);
  clearance::query prepared(g.gpu, g.robot, clearance::min_distance{});
  prepared.enqueue(its_poses.data().get(), balls_of(balls, 0.05), nullptr, result.data().get());
  g.gpu.wait();
  const clearance::min_distance_result r = result[0];
  const auto expected = ask(host{}, g.on_host, arm_poses, balls_of(records, 0.05), clearance::min_distance{});
  CHECK(same_answer(r, expected));
  CHECK((expected.lower > 0 && expected.lower < expected.upper - 0.049f));
}

}  // namespace solid_balls_device_test
