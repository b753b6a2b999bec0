// SPDX-License-Identifier: BSD-3-Clause
// What a control loop sees: the time from points in pinned memory to the answer on the host, a new pose with points
// that stay, frames back to back on one stream, and the worst cloud. Percentiles are counters, in microseconds.
#include "device.cuh"
#include "shell.hpp"
#include "tables.cuh"

#include <clearance/points/depth_image.hpp>
#include <clearance/volume/sphere.hpp>

namespace latency_bench {
namespace {

using namespace bench;
using clearance::device, clearance::vec3;

const auto& robot() {
  static const auto model = sphere_model<clearance::sphere>(the_scene());
  return model;
}

enum class way { given, copied, copy_alone };

/// From pinned memory to the answer on the host: the query reads them there, or they are copied before.
template <class T, class Make>
void from_pinned(benchmark::State& state, const std::vector<T>& data, way by, std::size_t calls, Make make) {
  const scene& s = the_scene();
  const device gpu;
  const auto model = robot().on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  const auto source = pinned(data, gpu);
  const clearance::device_buffer<T> there(data.size(), gpu.id);
  clearance::min_distance_result r;
  percentiles(state, calls, [&](std::size_t) {
    if (by == way::given) {
      r = query(s.poses, make(source.data()), s.world_from_camera);
      return;
    }
    clearance::check_cuda(
        cudaMemcpyAsync(there.data(), source.data(), data.size() * sizeof(T), cudaMemcpyHostToDevice, gpu.stream),
        "cudaMemcpyAsync");
    if (by == way::copied)
      r = query(s.poses, make(there.data()), s.world_from_camera);
    else
      gpu.wait();
  });
  if (by != way::copy_alone) state.counters["distance_mm"] = r.distance * 1e3;
}

void pinned_depth(benchmark::State& state, way by) {
  if (no_device(state)) return;
  // The frame's own depths. The fitted pinhole is close enough, because only time matters here.
  std::vector<std::uint16_t> depth;
  for (const vec3& p : the_scene().cloud) depth.push_back(clearance::is_finite(p) ? std::uint16_t(p.z * 1000) : 0);
  depth.resize(640 * 480);
  from_pinned(state, depth, by, 10000, [](const std::uint16_t* d) {
    return clearance::depth_image<std::uint16_t>(d, 640, 480, {525, 525, 319.5, 239.5});
  });
}
void pinned_points(benchmark::State& state, way by) {
  if (no_device(state)) return;
  const auto& points = repeated(the_scene().cloud, std::size_t(state.range(0)));
  from_pinned(state, points, by, points.size() > 1000000 ? 300 : 10000,
              [&](const vec3* p) { return clearance::point_span(p, points.size()); });
}

/// 1 kHz haptics: the points stay, the robot moves a little.
void new_pose(benchmark::State& state) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const device gpu;
  const auto model = robot().on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  const auto there = gpu.copy_in(std::span<const vec3>(s.cloud));
  const clearance::point_span view(there.data(), s.cloud.size());
  auto poses = s.poses;
  percentiles(state, 100000, [&](std::size_t k) {
    for (std::size_t part = 0; part < poses.size(); ++part)
      poses[part].translation() =
          s.poses[part].translation() + Eigen::Vector3d(0, 0, 0.01 * std::sin(0.01 * double(k)));
    benchmark::DoNotOptimize(query(poses, view, s.world_from_camera));
  });
}

/// The time per frame of a hundred that are enqueued at once.
void back_to_back(benchmark::State& state) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const device gpu;
  const auto model = robot().on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  const auto& points = repeated(s.cloud, std::size_t(state.range(0)));
  const auto there = gpu.copy_in(std::span<const vec3>(points));
  const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
  const device_clock clock;
  for (auto _ : state)
    state.SetIterationTime(clock.seconds([&] {
      for (int k = 0; k < 100; ++k)
        query.enqueue(s.poses,
                      clearance::placed{clearance::point_span(there.data(), points.size()), s.world_from_camera},
                      result.data());
    }) / 100);
}

/// Every point is 0.3 m from the robot, up to rounding: no bound culls anything.
void shell(benchmark::State& state, bool cold, bool ordered, tables its) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const device gpu;
  with_tables(gpu, robot(), its, [&](const auto& model) {
    clearance::query query(gpu, model, clearance::min_distance{});
    const clearance::device_buffer<vec3> there(static_cast<std::size_t>(state.range(0)), gpu.id);
    put_shell(gpu, model, s.poses, 0.3f, there.data(), there.size());
    if (ordered) put_in_order(gpu, there.data(), there.size());
    const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
    const device_clock clock;
    const auto frame = [&] {
      query.enqueue(s.poses, clearance::point_span(there.data(), there.size()), result.data());
    };
    frame();  // the first loads the kernel and is cold
    for (auto _ : state) {
      if (cold) query.forget();
      state.SetIterationTime(clock.seconds(frame));
    }
    const auto r = gpu.copy_out(result)[0];
    state.counters["distance_mm"] = r.distance * 1e3;
    state.counters["valid"] = double(r.valid);
  });
}

#define ONCE ->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(1)
BENCHMARK_CAPTURE(pinned_depth, given, way::given) ONCE;
BENCHMARK_CAPTURE(pinned_depth, copied, way::copied) ONCE;
BENCHMARK_CAPTURE(pinned_depth, copy_alone, way::copy_alone) ONCE;
BENCHMARK_CAPTURE(pinned_points, given, way::given)->Arg(307200)->Arg(5000000) ONCE;
BENCHMARK_CAPTURE(pinned_points, copied, way::copied)->Arg(307200)->Arg(5000000) ONCE;
BENCHMARK_CAPTURE(pinned_points, copy_alone, way::copy_alone)->Arg(307200)->Arg(5000000) ONCE;
BENCHMARK(new_pose) ONCE;
BENCHMARK(back_to_back)->Arg(307200)->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(20);
constexpr tables bare{}, cells{.cells = true};
#define SHELL ->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(50)
BENCHMARK_CAPTURE(shell, warm, false, false, bare) SHELL;
BENCHMARK_CAPTURE(shell, cold, true, false, bare) SHELL;
BENCHMARK_CAPTURE(shell, warm_ordered, false, true, bare) SHELL;
BENCHMARK_CAPTURE(shell, warm_cells, false, false, cells) SHELL;
BENCHMARK_CAPTURE(shell, cold_cells, true, false, cells) SHELL;
BENCHMARK_CAPTURE(shell, warm_ordered_cells, false, true, cells) SHELL;

}  // namespace
}  // namespace latency_bench

#undef ONCE

BENCHMARK_MAIN();
