// SPDX-License-Identifier: BSD-3-Clause
// Zones, lists, the nearest, confirmed points, motions, gradients and joint vectors on a GPU that holds the points.
// Calls that wait are timed by the host's clock. *enqueued* and *placed* use CUDA events, behind other work: in one
// call, with memory for it, or prepared. *fields*: of a robot whose parts have them.
#include "device.cuh"
#include "more_questions.hpp"

#include <clearance/compacted.cuh>
#include <clearance/device.cuh>
#include <clearance/io/joint_chain.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

namespace more_questions_bench {
namespace {

using namespace bench;
using clearance::device, clearance::vec3, clearance::point_counts, clearance::device_buffer;

auto model_there(const device& gpu, bool fields = false) {
  auto model = sphere_model<clearance::sphere>(the_scene());
  return (fields ? clearance::with_fields(gpu, std::move(model)).model : std::move(model)).on(gpu);
}

/// The robot and the frame on the GPU.
struct question {
  const scene& s = the_scene();
  device gpu;
  decltype(model_there(gpu)) model;
  device_buffer<vec3> points;
  clearance::placed<clearance::point_span> cloud;
  device_buffer<point_counts> counts{1, gpu.id};
  device_clock clock{true};

  explicit question(std::size_t count, bool fields = false)
      : model(model_there(gpu, fields)),
        points(gpu.copy_in(std::span<const vec3>(repeated(s.cloud, count)))),
        cloud{clearance::point_span(points.data(), points.size()), s.world_from_camera} {}

  template <class Frame>
  void time(benchmark::State& state, const Frame& frame) const {
    frame();
    for (auto _ : state) state.SetIterationTime(clock.seconds(frame));
  }
};

void zones(benchmark::State& state, bool prepared) {
  if (no_device(state)) return;
  question q(std::size_t(state.range(0)));
  const clearance::zones options{.thresholds = {0.1, 0.2, 0.4}};
  const device_buffer<clearance::zone> found(3 * q.model.size(), q.gpu.id);
  clearance::query query(q.gpu, q.model, clearance::zones{{0.0}});
  q.time(state, [&] {
    if (prepared)
      query.enqueue(q.s.poses, q.cloud, options, {found.data(), q.counts.data()});
    else
      clearance::enqueue(q.gpu, q.model, q.s.poses, q.cloud, options, {found.data(), q.counts.data()});
  });
}

void within(benchmark::State& state, bool prepared) {
  if (no_device(state)) return;
  question q(std::size_t(state.range(0)));
  const device_buffer<clearance::pair_distance> pairs(q.points.size(), q.gpu.id);
  const device_buffer<unsigned long long> count(1, q.gpu.id);
  const clearance::within near{{0.1f}};
  const clearance::within::out to{pairs.data(), pairs.size(), count.data(), q.counts.data()};
  clearance::query query(q.gpu, q.model, near);
  q.time(state, [&] {
    if (prepared)
      query.enqueue(q.s.poses, q.cloud, to);
    else
      clearance::enqueue(q.gpu, q.model, q.s.poses, q.cloud, near, to);
  });
  state.counters["pairs"] = double(q.gpu.copy_out(count)[0]);
}

void in_collision(benchmark::State& state, bool prepared) {
  if (no_device(state)) return;
  question q(std::size_t(state.range(0)));
  const device_buffer<clearance::collision_result> found(1, q.gpu.id);
  const clearance::in_collision near{{0.05}};
  clearance::query query(q.gpu, q.model, near);
  q.time(state, [&] {
    if (prepared)
      query.enqueue(q.s.poses, q.cloud, found.data());
    else
      clearance::enqueue(q.gpu, q.model, q.s.poses, q.cloud, near, found.data());
  });
}

void per_part(benchmark::State& state, float d_max) {
  if (no_device(state)) return;
  question q(std::size_t(state.range(0)));
  const device_buffer<float> distance(q.points.size() * q.model.size(), q.gpu.id);
  clearance::query query(q.gpu, q.model, clearance::distances_per_part{d_max});
  q.time(state, [&] { query.enqueue(q.s.poses, q.cloud, {distance.data(), q.counts.data()}); });
}

/// To triangles: signed, to compare with the distances that it computes first.
void to_triangles(benchmark::State& state, bool is_signed) {
  if (no_device(state)) return;
  question q(std::size_t(state.range(0)));
  const auto triangles = triangle_model<clearance::aabb>(q.s).on(q.gpu);
  const device_buffer<float> distance(q.points.size(), q.gpu.id);
  const clearance::distances_out out{.distance = distance.data()};
  q.time(state, [&] {
    if (is_signed)
      clearance::enqueue(q.gpu, triangles, q.s.poses, q.cloud, clearance::signed_distances{0.1f},
                         {out, q.counts.data()});
    else
      clearance::enqueue(q.gpu, triangles, q.s.poses, q.cloud, clearance::distances{0.1f}, {out, q.counts.data()});
  });
}

void compacted(benchmark::State& state) {
  if (no_device(state)) return;
  question q(std::size_t(state.range(0)));
  const device_buffer<vec3> points(q.points.size(), q.gpu.id);
  const device_buffer<std::uint32_t> numbers(q.points.size(), q.gpu.id), count(1, q.gpu.id);
  q.time(state,
         [&] { clearance::compacted_async(q.gpu, q.cloud.source, points.data(), numbers.data(), count.data()); });
  state.counters["points"] = double(q.gpu.copy_out(count)[0]);
}

/// The KUKA's seven joints; a stand-in's if its data is missing.
clearance::joint_chain<> seven_joints() {
  const std::size_t parts = the_scene().poses.size();
  if (the_scene().name == "kuka") return clearance::io::joint_chain_of(load_kuka(CLEARANCE_TEST_DATA));
  std::vector<clearance::chain_link> links(8);
  for (std::uint32_t k = 1; k < 8; ++k) {
    links[k].origin.m[2][3] = 0.2, links[k].parent = k - 1, links[k].value = k - 1;
    links[k].axis = k % 2 ? clearance::position{0, 0, 1} : clearance::position{0, 1, 0};
  }
  std::vector<std::uint32_t> of_part;
  for (std::uint32_t k = 0; k < parts; ++k) of_part.push_back(std::min(k, 7u));
  return clearance::joint_chain<>(links, of_part, std::vector<clearance::joint_value>(7));
}

std::vector<double> joint_vectors(std::size_t count) {
  std::mt19937 bits(5);
  std::vector<double> q(7 * count);
  for (double& j : q) j = 4.0 * (double(bits()) / 4294967296.0) - 2.0;
  return q;
}

/// Turns joint vectors on the GPU into poses, by the GPU's time.
void placed(benchmark::State& state) {
  if (no_device(state)) return;
  const question of(1);
  const auto chain = seven_joints().on(of.gpu);
  const auto q = of.gpu.copy_in(std::span<const double>(joint_vectors(std::size_t(state.range(0)))));
  clearance::query query(of.gpu, of.model, clearance::min_distances{});
  of.time(state, [&] { query.place(chain, q.data(), std::size_t(state.range(0))); });
}
/// Turns joint vectors on the host into poses, by the host's clock. *there*: the GPU makes the poses, else the host
/// does.
void placed_call(benchmark::State& state, bool there) {
  if (no_device(state)) return;
  const question of(1);
  const auto chain = seven_joints();
  const auto on_gpu = chain.on(of.gpu);
  const auto q = joint_vectors(std::size_t(state.range(0)));
  clearance::query query(of.gpu, of.model, clearance::min_distances{});
  ask_often(state, [&] {
    if (there)
      query.place(on_gpu, q);
    else
      query.place(chain.poses(q));
    of.gpu.wait();
    return true;
  });
}

#define TIMES ->Arg(307200)->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(50)
BENCHMARK_CAPTURE(zones, enqueued_at_once, false) TIMES;
BENCHMARK_CAPTURE(zones, enqueued_prepared, true) TIMES;
BENCHMARK_CAPTURE(within, enqueued_at_once, false) TIMES;
BENCHMARK_CAPTURE(within, enqueued_prepared, true) TIMES;
BENCHMARK_CAPTURE(in_collision, enqueued_at_once, false) TIMES;
BENCHMARK_CAPTURE(in_collision, enqueued_prepared, true) TIMES;
BENCHMARK_CAPTURE(per_part, enqueued_10cm, 0.1f) TIMES;
BENCHMARK_CAPTURE(per_part, enqueued_50cm, 0.5f) TIMES;
BENCHMARK_CAPTURE(per_part, enqueued_untruncated, clearance::infinity) TIMES;
BENCHMARK_CAPTURE(to_triangles, enqueued_at_once_10cm, false) TIMES;
BENCHMARK_CAPTURE(to_triangles, enqueued_at_once_10cm_signed, true) TIMES;
BENCHMARK(compacted) TIMES;
BENCHMARK(placed)->Arg(4096)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(50);
BENCHMARK_CAPTURE(placed_call, there, true)->Arg(4096)->UseRealTime()->Unit(benchmark::kMicrosecond)->Iterations(20);
BENCHMARK_CAPTURE(placed_call, by_the_host, false)
    ->Arg(4096)
    ->UseRealTime()
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(20);

const int rows = [] {
  for_each_question([](const std::string& name, const auto& row) {
    for (const bool fields : {false, true})
      benchmark::RegisterBenchmark((fields ? name + "/fields" : name).c_str(),
                                   [row, fields](benchmark::State& state) {
                                     if (no_device(state)) return;
                                     const question q(307200, fields);
                                     row(state, q.gpu, q.model, q.cloud);
                                   })
          ->UseRealTime()
          ->Unit(benchmark::kMicrosecond)
          ->Iterations(200);
  });
  return 0;
}();

}  // namespace
}  // namespace more_questions_bench

#undef TIMES

BENCHMARK_MAIN();
