// SPDX-License-Identifier: BSD-3-Clause
// What callers may rely on with their own streams, devices and memory.
#include "support/held_stream.cuh"
#include "support/linked_tree.hpp"
#include "support/product_device.cuh"
#include "support/volumes.hpp"

#include <clearance/volume/sphere.hpp>

#include <atomic>
#include <chrono>
#include <thread>

namespace async_test {

using namespace testing;
using clearance::device, clearance::min_distance, clearance::min_distance_result, clearance::point_span;

namespace {

/// Memory of one kind, with one result in it.
struct answer {
  bool pinned;
  min_distance_result* at = nullptr;
  explicit answer(bool pinned) : pinned(pinned) {
    check(pinned ? cudaMallocHost(&at, sizeof *at) : cudaMalloc(&at, sizeof *at));
  }
  ~answer() { pinned ? cudaFreeHost(at) : cudaFree(at); }
  answer(const answer&) = delete;
  min_distance_result read() const {
    min_distance_result r;
    check(cudaMemcpy(&r, at, sizeof r, cudaMemcpyDefault));
    return r;
  }
};

/// What a controller would do in the same stream, without the host.
__global__ void brake(const min_distance_result* r, float* speed) { *speed = r->lower < 0.05f ? 0 : r->lower; }

struct robot_and_cloud {
  scene<inner_sphere> s = scenes<inner_sphere>()[1];
  decltype(make_model<clearance::sphere>(s, {}, clearance::wrapped{})) on_host =
      make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  min_distance_result expected = ask(clearance::host{}, on_host, s.poses, point_span(s.points), min_distance{});
};

}  // namespace

TEST_CASE(
    "The asynchronous call returns while its stream is held, and a following kernel reads the result without the "
    "host") {
  const robot_and_cloud given;
  const own_stream stream;
  const device gpu{0, stream.handle};
  const auto model = given.on_host.on(gpu);
  const auto points = gpu.copy_in(std::span<const vec3>(given.s.points));
  const point_span cloud(points.data(), points.size());
  float* speed = nullptr;
  check(cudaMallocHost(&speed, sizeof *speed));
  for (const bool pinned : {false, true}) {
    const answer result(pinned);
    const auto enqueue = [&] {
      auto poses = given.s.poses;
      clearance::enqueue(gpu, model, poses, cloud, min_distance{}, result.at);
      brake<<<1, 1, 0, stream.handle>>>(result.at, speed);
      check(cudaGetLastError());
      for (auto& pose : poses) pose.setIdentity();  // what was passed may go
    };
    enqueue();
    check(cudaStreamSynchronize(stream.handle));
    *speed = -1;
    gate held(stream.handle);
    enqueue();
    // We are here although nothing of it can have run.
    CHECK(cudaStreamQuery(stream.handle) == cudaErrorNotReady);
    CHECK(*static_cast<volatile float*>(speed) == -1);
    held.release();
    CHECK(same_result(result.read(), given.expected));
    CHECK(*speed == given.expected.lower);
  }
  cudaFreeHost(speed);
}

TEST_CASE("Part minima arrive in device memory too") {
  const robot_and_cloud given;
  const device gpu;
  const auto model = given.on_host.on(gpu);
  const auto points = gpu.copy_in(std::span<const vec3>(given.s.points));
  const answer result(true);
  auto minima = gpu.make_scratch<clearance::part_minimum>(model.size());
  clearance::enqueue(gpu, model, given.s.poses, point_span(points.data(), points.size()),
                     clearance::min_distance_per_part{}, {result.at, minima.data()});
  const auto got = gpu.copy_out(minima.data(), minima.size());
  const auto [r, expected] = clearance::ask(clearance::host{}, given.on_host, given.s.poses, point_span(given.s.points),
                                            clearance::min_distance_per_part{});
  CHECK(same_result(result.read(), r));
  REQUIRE(got.size() == expected.size());
  for (std::size_t k = 0; k < got.size(); ++k) CHECK(same_bytes(got[k], expected[k]));
}

TEST_CASE("Several streams at once, one of them held, do not disturb one another", "[concurrent]") {
  const robot_and_cloud given;
  const own_stream streams[3];
  const auto model = given.on_host.on(device{});
  const auto points = device{}.copy_in(std::span<const vec3>(given.s.points));
  const answer results[3] = {answer(true), answer(false), answer(true)};
  enqueue(device{}, model, given.s.poses, point_span(points.data(), points.size()), min_distance{}, results[0].at);
  check(cudaDeviceSynchronize());
  gate held(streams[0].handle);
  for (int round = 0; round < 20; ++round)
    for (int k = 0; k < 3; ++k)
      enqueue(device{0, streams[k].handle}, model, given.s.poses, point_span(points.data(), points.size()),
              min_distance{}, results[k].at);
  check(cudaStreamSynchronize(streams[1].handle));
  check(cudaStreamSynchronize(streams[2].handle));
  CHECK(cudaStreamQuery(streams[0].handle) == cudaErrorNotReady);
  held.release();
  check(cudaDeviceSynchronize());
  for (const answer& r : results) CHECK(same_result(r.read(), given.expected));
}

TEST_CASE("Points may lie in pageable, pinned or device memory") {
  const robot_and_cloud given;
  const device gpu;
  const auto model = given.on_host.on(gpu);
  CHECK(same_result(ask(gpu, model, given.s.poses, given.s.points, min_distance{}), given.expected));
  vec3* pinned = nullptr;
  check(cudaMallocHost(&pinned, given.s.points.size() * sizeof(vec3)));
  std::copy(given.s.points.begin(), given.s.points.end(), pinned);
  CHECK(same_result(ask(gpu, model, given.s.poses, point_span(pinned, given.s.points.size()), min_distance{}),
                    given.expected));
  cudaFreeHost(pinned);
  const auto there = gpu.copy_in(std::span<const vec3>(given.s.points));
  CHECK(same_result(ask(gpu, model, given.s.poses, point_span(there.data(), there.size()), min_distance{}),
                    given.expected));
}

TEST_CASE("Every device works, whichever is current, and the current one stays") {
  const robot_and_cloud given;
  int devices = 0;
  check(cudaGetDeviceCount(&devices));
  for (int current = 0; current < devices; ++current)
    for (int used = 0; used < devices; ++used) {
      check(cudaSetDevice(current));
      {
        const device gpu{used};
        const auto model = given.on_host.on(gpu);
        CHECK(same_result(ask(gpu, model, given.s.poses, given.s.points, min_distance{}), given.expected));
      }
      int now = -1;
      check(cudaGetDevice(&now));
      CHECK(now == current);
    }
  check(cudaSetDevice(0));
}

TEST_CASE(
    "A recursion is refused while the stack limit is too small, leaves the limit alone, and runs once it is raised") {
  const device gpu;
  std::vector<inner_sphere> line;
  for (int k = 0; k < 60; ++k) line.push_back({{real(k), 0, 0}, 0.25f});
  const linked_tree<clearance::sphere, inner_sphere> tree(line, true);
  using node = linked_tree<clearance::sphere, inner_sphere>::node;
  auto nodes = gpu.copy_in(std::span<const node>(tree.placed_at(tree.view().top)));  // for its address
  const auto moved = tree.placed_at(nodes.data());
  check(cudaMemcpy(nodes.data(), moved.data(), moved.size() * sizeof(node), cudaMemcpyHostToDevice));
  using view = clearance::part_view<linked_view<clearance::sphere, inner_sphere>>;
  const clearance::part_facts facts{{30, 0, 0}, 31, 0, 0};
  const view part{{nodes.data(), tree.view().depth()}, {}, facts};
  const auto parts = gpu.copy_in(std::span<const view>(&part, 1));
  const clearance::model_view<view> model{parts.data(), {&facts, 1}, tree.view().depth(), 2};
  const std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};
  std::vector<vec3> points(5000, {-1, 0, 0});  // so many that every kind of kernel takes part
  points[0] = {57, 1, 0};
  {
    const deep_stack small(1024);
    std::size_t limit = 0;
    check(cudaDeviceGetLimit(&limit, cudaLimitStackSize));
    try {
      ask(clearance::plain{gpu, clearance::recursive{}}, model, poses, points, min_distance{});
      FAIL("not refused");
    } catch (const std::invalid_argument& e) {
      CHECK(std::string(e.what()).find("cudaLimitStackSize") != std::string::npos);
      CHECK(std::string(e.what()).find("limit is " + std::to_string(limit)) != std::string::npos);
    }
    std::size_t after = 0;
    check(cudaDeviceGetLimit(&after, cudaLimitStackSize));
    CHECK(after == limit);
    CHECK(ask(clearance::plain{gpu, clearance::stack{}}, model, poses, points, min_distance{}).primitive ==
          57);  // needs none
  }
  const deep_stack enough(clearance::recursive::device_stack(tree.view().depth()));
  const auto r = ask(clearance::plain{gpu, clearance::recursive{}}, model, poses, points, min_distance{});
  CHECK(r.primitive == 57);
  CHECK(r.distance == 0.75f);
  check(cudaDeviceSynchronize());
}

TEST_CASE("A tree too deep for a stack is refused before anything is launched") {
  const device gpu;
  const clearance::part_facts facts;
  using view = clearance::part_view<linked_view<clearance::sphere, inner_sphere>>;
  const clearance::model_view<view> model{nullptr, {&facts, 1}, 64, 2};
  const std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};
  CHECK_THROWS_AS(
      ask(clearance::plain{gpu, clearance::near_first{}}, model, poses, std::vector<vec3>{{1, 2, 3}}, min_distance{}),
      std::invalid_argument);
  CHECK_THROWS_AS(
      ask(clearance::plain{gpu, clearance::stack{}}, model, poses, std::vector<vec3>{{1, 2, 3}}, min_distance{}),
      std::invalid_argument);
}

TEST_CASE("A model may go as soon as its queries are enqueued") {
  const robot_and_cloud given;
  const own_stream stream;
  const device gpu{0, stream.handle};
  const answer result(true);
  const auto points = gpu.copy_in(std::span<const vec3>(given.s.points));
  for (int round = 0; round < 10; ++round) {
    {
      const auto model = given.on_host.on(gpu);
      enqueue(gpu, model, given.s.poses, point_span(points.data(), points.size()), min_distance{}, result.at);
    }  // giving memory back waits
    check(cudaStreamSynchronize(stream.handle));
    CHECK(same_result(result.read(), given.expected));
  }
}

TEST_CASE("Foreign boxes and volumes of one's own work in kernels") {
  const device gpu;
  verdict v;
  for (const auto& s : scenes<triangle>()) {
    const auto expected = brute_force(brute_parts(s), s.poses, {brute_cloud(point_span(s.points), s.cloud_pose)});
    const clearance::placed cloud{point_span(s.points), s.cloud_pose};
    const auto boxes = make_model<Eigen::AlignedBox3f>(s, {}, clearance::wrapped{}).on(gpu);
    require_equal(ask(gpu, boxes, s.poses, cloud, min_distance{}), expected, v, s.name);
    const auto slabs = make_model<kdop14>(s, {.width = 2}, clearance::wrapped{}).on(gpu);
    require_equal(ask(gpu, slabs, s.poses, cloud, min_distance{}), expected, v, s.name);
  }
}

TEST_CASE("Clouds of different kinds share one search on the device too") {
  const device gpu;
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto on_host = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto model = on_host.on(gpu);
    const clearance::placed span{all.span, s.cloud_pose};
    const auto clouds = std::tuple(clearance::placed{all.raw, all.camera_pose}, span, span);
    const auto expected = brute_force(brute_parts(s), s.poses,
                                      {brute_cloud(all.raw, all.camera_pose), brute_cloud(all.span, s.cloud_pose),
                                       brute_cloud(all.span, s.cloud_pose)});
    require_equal(ask(gpu, model, s.poses, clouds, min_distance{}), expected, v, s.name);
    require_equal(ask(clearance::plain{gpu, clearance::near_first{}}, model, s.poses, clouds, min_distance{}), expected,
                  v, s.name + ", plain");
  }
}

}  // namespace async_test
