// SPDX-License-Identifier: BSD-3-Clause
// Every point's own distance on a GPU, the points resident there; beside it the same cloud's one minimum. CUDA events, behind
// other work.
#include "device.cuh"
#include "shell.hpp"

#include <clearance/distances.cuh>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <algorithm>

namespace {

using namespace bench;
using clearance::device, clearance::vec3;

template <class Model>
void ask(benchmark::State& state, const Model& model, const std::vector<Eigen::Isometry3d>& poses, const Eigen::Isometry3d& pose, const vec3* points,
         std::size_t count, float d_max) {
  const device gpu;
  const auto there = model.on(gpu);
  clearance::pointwise::device_points<typename decltype(there)::view_type> query(gpu, there.view());
  const clearance::device_buffer<float> out(count, gpu.id);
  const clearance::device_buffer<clearance::point_counts> counts(1, gpu.id);
  const clearance::placed cloud{clearance::point_span(points, count), pose};
  const device_clock clock(true);
  const auto frame = [&] { query.enqueue(poses, cloud, {out.data()}, d_max, counts.data(), clearance::minimum::as_it_is{}); };
  frame();
  for (auto _ : state) state.SetIterationTime(clock.seconds(frame));
  double sum = 0;
  std::size_t near = 0;
  for (const float d : gpu.copy_out(out))
    if (d < clearance::infinity) sum += d, ++near;
  state.counters["near"] = double(near);
  state.counters["mean_mm"] = 1e3 * sum / double(near);
}

template <class Make>
void frame(benchmark::State& state, Make make, float d_max) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const auto& points = repeated(s.cloud, std::size_t(state.range(0)));
  const auto there = device{}.copy_in(std::span<const vec3>(points));
  ask(state, make(s), s.poses, s.world_from_camera, there.data(), points.size(), d_max);
}

void spheres(benchmark::State& state, float d_max) { frame(state, [](const scene& s) { return sphere_model<clearance::sphere>(s); }, d_max); }
void triangles(benchmark::State& state, float d_max) { frame(state, [](const scene& s) { return triangle_model<clearance::aabb>(s); }, d_max); }

/// Points of the worst cloud there is, so that only what is nearer than their own distance counts; in random order, or as a sensor
/// sees them: neighbours beside one another (along a Z-curve of 2 mm).
void shell(benchmark::State& state, bool ordered) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const device gpu;
  const auto model = sphere_model<clearance::sphere>(s);
  const clearance::device_buffer<vec3> there(std::size_t(state.range(0)), gpu.id);
  {
    const auto on_gpu = model.on(gpu);
    put_shell(gpu, on_gpu, s.poses, 0.3f, there.data(), there.size());
  }
  if (ordered) {
    auto points = gpu.copy_out(there);
    const auto place = [](vec3 p) {
      std::uint64_t code = 0;
      const std::uint64_t x = std::uint64_t((p.x + 8) * 500), y = std::uint64_t((p.y + 8) * 500), z = std::uint64_t((p.z + 8) * 500);
      for (int b = 0; b < 14; ++b) code |= (x >> b & 1) << 3 * b | (y >> b & 1) << (3 * b + 1) | (z >> b & 1) << (3 * b + 2);
      return code;
    };
    std::ranges::sort(points, {}, place);
    gpu.stage(std::span<const vec3>(points), there.data());
  }
  ask(state, model, s.poses, Eigen::Isometry3d::Identity(), there.data(), there.size(), 0.3f - 2e-6f);
}
BENCHMARK_CAPTURE(shell, random, false)->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(20);
BENCHMARK_CAPTURE(shell, ordered, true)->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(20);

constexpr float all = clearance::infinity;
#define TIMES ->Arg(307200)->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(30)
BENCHMARK_CAPTURE(spheres, untruncated, all) TIMES;
BENCHMARK_CAPTURE(spheres, within_10cm, 0.1f) TIMES;
BENCHMARK_CAPTURE(triangles, untruncated, all) TIMES;
BENCHMARK_CAPTURE(triangles, within_10cm, 0.1f) TIMES;

}  // namespace

BENCHMARK_MAIN();
