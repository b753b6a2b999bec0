// SPDX-License-Identifier: BSD-3-Clause
// One frame on a GPU, its points resident there: the prepared query warm (it remembers the last frame) and cold, beside a
// kernel that only reads the points. Times are CUDA events around the enqueued frame.
#include "crowds.hpp"
#include "device.cuh"
#include "scene_files.hpp"

#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace {

using namespace bench;

/// Writes more than the L2 cache holds, so that the next kernel finds nothing there.
class cache_flush {
 public:
  void operator()() const { clearance::check_cuda(cudaMemsetAsync(dirt_.data(), 1, dirt_.size()), "cudaMemsetAsync"); }

 private:
  clearance::device_buffer<std::byte> dirt_{256u << 20, 0};
};

void read(benchmark::State& state, bool flushed) {
  if (no_device(state)) return;
  const clearance::device gpu;
  const auto& points = repeated(bench::the_scene().cloud, std::size_t(state.range(0)));
  const auto there = gpu.copy_in(std::span<const clearance::vec3>(points));
  const clearance::device_buffer<float> never(1, gpu.id);
  const device_clock clock;
  const cache_flush flush;
  for (auto _ : state) {
    if (flushed) flush();
    state.SetIterationTime(clock.seconds([&] {
      read_kernel<><<<264, 512>>>(reinterpret_cast<const float4*>(there.data()), points.size() * 3 / 4, never.data());
    }));
  }
}

template <class Model>
void ask_in(const bench::scene& s, benchmark::State& state, const Model& model, bool cold, bool plain = false, bool each = false,
            bool flushed = false) {
  const clearance::device gpu;
  const auto& points = repeated(s.cloud, std::size_t(state.range(0)));
  const auto there = gpu.copy_in(std::span<const clearance::vec3>(points));
  const clearance::point_span view(there.data(), points.size());
  const auto placed_there = model.on(gpu);
  clearance::min_distance_query query(gpu, placed_there);
  const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
  const clearance::device_buffer<clearance::part_minimum> minima(s.poses.size(), gpu.id);
  const device_clock clock;
  const cache_flush flush;
  const auto frame = [&] {
    if (plain)
      clearance::min_distance_async(gpu, placed_there, s.poses, clearance::placed<clearance::point_span>{view, s.world_from_camera}, result.data());
    else
      query.enqueue(s.poses, view, s.world_from_camera, result.data(), each ? minima.data() : nullptr);
  };
  frame();
  for (auto _ : state) {
    if (cold) query.forget();
    if (flushed) flush();
    state.SetIterationTime(clock.seconds(frame));
  }
  state.counters["distance_mm"] = gpu.copy_out(result)[0].distance * 1e3;
}
template <class Model, class... How>
void ask(benchmark::State& state, const Model& model, How... how) {
  ask_in(bench::the_scene(), state, model, how...);
}

template <class V>
const auto& spheres() {
  static const auto model = bench::sphere_model<V>(bench::the_scene());
  return model;
}
template <class V>
const auto& triangles() {
  static const auto model = bench::triangle_model<V>(bench::the_scene());
  return model;
}

template <class V>
void spheres_warm(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), false);
}
template <class V>
void spheres_cold(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), true);
}
template <class V>
void spheres_plain(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), false, true);
}
template <class V>
void spheres_warm_flushed(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), false, false, false, true);
}
template <class V>
void every_part_warm(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), false, false, true);
}
template <class V>
void every_part_cold(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), true, false, true);
}
template <class V>
void triangles_warm(benchmark::State& state) {
  if (!no_device(state)) ask(state, triangles<V>(), false);
}
template <class V>
void triangles_cold(benchmark::State& state) {
  if (!no_device(state)) ask(state, triangles<V>(), true);
}

template <bench::scene (*Make)(const bench::scene&)>
void crowd(benchmark::State& state, bool cold, bool each) {
  if (no_device(state)) return;
  static const bench::scene s = Make(bench::the_scene());
  static const auto model = bench::sphere_model<clearance::sphere>(s);
  ask_in(s, state, model, cold, false, each);
}
constexpr auto sixty_four_parts = crowd<bench::sixty_four_parts>;
constexpr auto two_robots_20_m_apart = crowd<bench::two_robots>;
constexpr auto one_part_of_100000 = crowd<bench::one_large_part>;

#define FRAME ->Arg(307200)->ArgName("points")->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200)->Repetitions(3)->ReportAggregatesOnly()
#define MORE ->Arg(307200)->Arg(5000000)->Arg(50000000)->ArgName("points")->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200)->Repetitions(3)->ReportAggregatesOnly()
BENCHMARK_CAPTURE(read, warm, false) MORE;
BENCHMARK_CAPTURE(read, flushed, true) MORE;
BENCHMARK(spheres_warm<clearance::sphere>) MORE;
BENCHMARK(spheres_cold<clearance::sphere>) MORE;
BENCHMARK(spheres_warm_flushed<clearance::sphere>) MORE;
BENCHMARK(every_part_warm<clearance::sphere>) MORE;
BENCHMARK(every_part_cold<clearance::sphere>) MORE;
BENCHMARK(spheres_plain<clearance::sphere>) FRAME;
BENCHMARK(spheres_warm<clearance::aabb>) FRAME;
BENCHMARK(spheres_warm<clearance::obb>) FRAME;
BENCHMARK(triangles_warm<clearance::sphere>) FRAME;
BENCHMARK(triangles_warm<clearance::aabb>) FRAME;
BENCHMARK(triangles_warm<clearance::obb>) FRAME;
BENCHMARK(triangles_cold<clearance::aabb>) FRAME;
BENCHMARK(triangles_cold<clearance::obb>) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, warm, false, false) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, cold, true, false) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, every_part_warm, false, true) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, every_part_cold, true, true) FRAME;
BENCHMARK_CAPTURE(two_robots_20_m_apart, warm, false, false) FRAME;
BENCHMARK_CAPTURE(two_robots_20_m_apart, cold, true, false) FRAME;
BENCHMARK_CAPTURE(one_part_of_100000, warm, false, false) FRAME;
BENCHMARK_CAPTURE(one_part_of_100000, cold, true, false) FRAME;

}  // namespace

int main(int argc, char** argv) { return bench::main(argc, argv); }
