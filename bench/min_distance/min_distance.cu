// SPDX-License-Identifier: BSD-3-Clause
// One frame on a GPU that holds its points: the prepared query warm (it remembers the last frame) and cold, compared
// with a kernel that only reads the points and one that does nothing. Times are CUDA events around the frame on an idle
// device, including the host's time to launch. In `queued` rows the device is busy, and the time is its own alone.
#include "crowds.hpp"
#include "device.cuh"
#include "scene_files.hpp"
#include "tables.cuh"

#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace min_distance_bench {
namespace {

using namespace bench;

/// Writes more than the L2 cache holds, so that the next kernel finds it cold.
class cache_flush {
 public:
  void operator()() const { clearance::check_cuda(cudaMemsetAsync(dirt_.data(), 1, dirt_.size()), "cudaMemsetAsync"); }

 private:
  clearance::device_buffer<std::byte> dirt_{256u << 20, 0};
};

/// How to ask and time a frame.
struct manner {
  bool cold = false;       ///< Nothing is known about the last frame.
  bool plain = false;      ///< The loop over points with a traversal.
  bool once = false;       ///< In one call, unprepared.
  bool each = false;       ///< Also every part's minimum.
  bool flushed = false;    ///< The cache is cold.
  bool queued = false;     ///< Behind other work.
  bench::tables its = {};  ///< What its parts have.
};

void empty(benchmark::State& state, bool queued) {
  if (no_device(state)) return;
  const device_clock clock(queued);
  const auto launch = [] { empty_kernel<><<<1, 32>>>(); };
  launch();  // the first launch loads the kernel
  for (auto _ : state) state.SetIterationTime(clock.seconds(launch));
}

void read(benchmark::State& state, manner how) {
  if (no_device(state)) return;
  const clearance::device gpu;
  const auto& points = repeated(bench::the_scene().cloud, std::size_t(state.range(0)));
  const auto there = gpu.copy_in(std::span<const clearance::vec3>(points));
  const clearance::device_buffer<float> never(1, gpu.id);
  const device_clock clock(how.queued);
  const cache_flush flush;
  const auto launch = [&] {
    read_kernel<><<<264, 512>>>(reinterpret_cast<const float4*>(there.data()), points.size() * 3 / 4, never.data());
  };
  launch();
  for (auto _ : state) {
    if (how.flushed) flush();
    state.SetIterationTime(clock.seconds(launch));
  }
}

template <class Model>
void ask(benchmark::State& state, const bench::scene& s, const Model& model, manner how) {
  const clearance::device gpu;
  const auto& points = repeated(s.cloud, std::size_t(state.range(0)));
  const auto there = gpu.copy_in(std::span<const clearance::vec3>(points));
  const clearance::point_span view(there.data(), points.size());
  bench::with_tables(gpu, model, how.its, [&](const auto& placed_there) {
    clearance::query query(gpu, placed_there, clearance::min_distance{});
    clearance::query each(gpu, placed_there, clearance::min_distance_per_part{});
    const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
    const clearance::device_buffer<clearance::part_minimum> minima(s.poses.size(), gpu.id);
    const device_clock clock(how.queued);
    const cache_flush flush;
    const clearance::placed cloud{view, s.world_from_camera};
    const auto frame = [&] {
      if (how.plain)
        clearance::enqueue(clearance::plain{gpu, clearance::near_first{}}, placed_there, s.poses, cloud,
                           clearance::min_distance{}, result.data());
      else if (how.once)
        clearance::enqueue(gpu, placed_there, s.poses, cloud, clearance::min_distance{}, result.data());
      else if (how.each)
        each.enqueue(s.poses, cloud, {result.data(), minima.data()});
      else
        query.enqueue(s.poses, cloud, result.data());
    };
    frame();
    for (auto _ : state) {
      if (how.cold) how.each ? each.forget() : query.forget();
      if (how.flushed) flush();
      state.SetIterationTime(clock.seconds(frame));
    }
    state.counters["distance_mm"] = gpu.copy_out(result)[0].distance * 1e3;
  });
}
template <class Model>
void ask(benchmark::State& state, const Model& model, manner how = {}) {
  ask(state, bench::the_scene(), model, how);
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
  if (!no_device(state)) ask(state, spheres<V>());
}
template <class V>
void spheres_cold(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.cold = true});
}
template <class V>
void spheres_plain(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.plain = true});
}
template <class V>
void spheres_once(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.once = true});
}
template <class V>
void spheres_warm_flushed(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.flushed = true});
}
template <class V>
void spheres_warm_queued(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.queued = true});
}
template <class V>
void spheres_cold_queued(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.cold = true, .queued = true});
}
template <class V>
void every_part_warm(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.each = true});
}
template <class V>
void every_part_cold(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.cold = true, .each = true});
}
template <class V>
void every_part_warm_queued(benchmark::State& state) {
  if (!no_device(state)) ask(state, spheres<V>(), {.each = true, .queued = true});
}
template <class V>
void triangles_warm(benchmark::State& state) {
  if (!no_device(state)) ask(state, triangles<V>());
}
template <class V>
void triangles_cold(benchmark::State& state) {
  if (!no_device(state)) ask(state, triangles<V>(), {.cold = true});
}
template <class V>
void triangles_warm_queued(benchmark::State& state) {
  if (!no_device(state)) ask(state, triangles<V>(), {.queued = true});
}
template <class V>
void triangles_cold_queued(benchmark::State& state) {
  if (!no_device(state)) ask(state, triangles<V>(), {.cold = true, .queued = true});
}

void with_fields(benchmark::State& state, manner how) {
  how.its.fields = true;
  if (!no_device(state)) ask(state, spheres<clearance::sphere>(), how);
}

void with_cells(benchmark::State& state, manner how) {
  how.its.cells = true;
  if (!no_device(state)) ask(state, spheres<clearance::sphere>(), how);
}
void triangles_with_cells(benchmark::State& state, manner how) {
  how.its.cells = true;
  if (!no_device(state)) ask(state, triangles<clearance::aabb>(), how);
}

template <bench::scene (*Make)(const bench::scene&)>
void crowd(benchmark::State& state, manner how) {
  if (no_device(state)) return;
  static const bench::scene s = Make(bench::the_scene());
  static const auto model = bench::sphere_model<clearance::sphere>(s);
  ask(state, s, model, how);
}
constexpr auto sixty_four_parts = crowd<bench::sixty_four_parts>;
constexpr auto two_robots_20_m_apart = crowd<bench::two_robots>;
constexpr auto one_part_of_100000 = crowd<bench::one_large_part>;

#define TIMED ->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(200)->Repetitions(3)->ReportAggregatesOnly()
#define FRAME ->Arg(307200)->ArgName("points") TIMED
#define MORE ->Arg(307200)->Arg(5000000)->Arg(50000000)->ArgName("points") TIMED
BENCHMARK_CAPTURE(empty, idle, false) TIMED;
BENCHMARK_CAPTURE(empty, queued, true) TIMED;
BENCHMARK_CAPTURE(read, warm, {}) MORE;
BENCHMARK_CAPTURE(read, flushed, {.flushed = true}) MORE;
BENCHMARK_CAPTURE(read, queued, {.queued = true}) MORE;
BENCHMARK(spheres_warm<clearance::sphere>) MORE;
BENCHMARK(spheres_cold<clearance::sphere>) MORE;
BENCHMARK(spheres_warm_flushed<clearance::sphere>) MORE;
BENCHMARK(spheres_warm_queued<clearance::sphere>) MORE;
BENCHMARK(spheres_cold_queued<clearance::sphere>) MORE;
BENCHMARK(every_part_warm<clearance::sphere>) MORE;
BENCHMARK(every_part_cold<clearance::sphere>) MORE;
BENCHMARK(every_part_warm_queued<clearance::sphere>) MORE;
BENCHMARK(spheres_plain<clearance::sphere>) FRAME;
BENCHMARK(spheres_once<clearance::sphere>) FRAME;
BENCHMARK(spheres_warm<clearance::aabb>) FRAME;
BENCHMARK(spheres_warm<clearance::obb>) FRAME;
BENCHMARK(triangles_warm<clearance::sphere>) FRAME;
BENCHMARK(triangles_warm<clearance::aabb>) FRAME;
BENCHMARK(triangles_warm<clearance::obb>) FRAME;
BENCHMARK(triangles_cold<clearance::aabb>) FRAME;
BENCHMARK(triangles_cold<clearance::obb>) FRAME;
BENCHMARK(triangles_warm_queued<clearance::aabb>) FRAME;
BENCHMARK(triangles_cold_queued<clearance::aabb>) FRAME;
BENCHMARK_CAPTURE(with_fields, cold, {.cold = true}) FRAME;
BENCHMARK_CAPTURE(with_fields, cold_queued, {.cold = true, .queued = true}) FRAME;
BENCHMARK_CAPTURE(with_fields, every_part_cold, {.cold = true, .each = true}) FRAME;
BENCHMARK_CAPTURE(with_fields, warm_queued, {.queued = true}) FRAME;
BENCHMARK_CAPTURE(with_cells, cold, {.cold = true}) FRAME;
BENCHMARK_CAPTURE(with_cells, cold_queued, {.cold = true, .queued = true}) FRAME;
BENCHMARK_CAPTURE(with_cells, every_part_cold, {.cold = true, .each = true}) FRAME;
BENCHMARK_CAPTURE(with_cells, every_part_warm, {.each = true}) FRAME;
BENCHMARK_CAPTURE(with_cells, warm_queued, {.queued = true}) MORE;
BENCHMARK_CAPTURE(triangles_with_cells, cold_queued, {.cold = true, .queued = true}) FRAME;
BENCHMARK_CAPTURE(triangles_with_cells, warm_queued, {.queued = true}) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, warm, {}) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, cold, {.cold = true}) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, every_part_warm, {.each = true}) FRAME;
BENCHMARK_CAPTURE(sixty_four_parts, every_part_cold, {.cold = true, .each = true}) FRAME;
BENCHMARK_CAPTURE(two_robots_20_m_apart, warm, {}) FRAME;
BENCHMARK_CAPTURE(two_robots_20_m_apart, cold, {.cold = true}) FRAME;
BENCHMARK_CAPTURE(one_part_of_100000, warm, {}) FRAME;
BENCHMARK_CAPTURE(one_part_of_100000, cold, {.cold = true}) FRAME;

}  // namespace
}  // namespace min_distance_bench

int main(int argc, char** argv) { return bench::run_all(argc, argv); }
