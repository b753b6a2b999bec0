// SPDX-License-Identifier: BSD-3-Clause
// One frame on the CPU: 307,200 points and the whole robot, by model and volume. *warm* is a prepared query that
// remembers the last frame, *cold* one that does not, *plain* one call, *parts* warm with every part's minimum.
#include "crowds.hpp"

#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

#include <benchmark/benchmark.h>

namespace min_distance_bench {
namespace {

enum kind { warm, cold, plain, parts };

template <class Model, class Source>
void ask(benchmark::State& state, const Model& model, const Source& source, kind how,
         const bench::scene& s = bench::the_scene()) {
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const clearance::placed<Source> cloud{source, s.world_from_camera};
  clearance::query query(cpu, model, clearance::min_distance{});
  clearance::query each(cpu, model, clearance::min_distance_per_part{});
  clearance::min_distance_result r;
  for (auto _ : state) {
    if (how == cold) query.forget();
    r = how == plain   ? clearance::ask(cpu, model, s.poses, cloud, clearance::min_distance{})
        : how == parts ? each(s.poses, cloud).all
                       : query(s.poses, cloud);
  }
  state.counters["distance_mm"] = r.distance * 1e3;
  state.counters["points"] = double(source.size());
}

template <class V, kind How>
void spheres(benchmark::State& state) {
  static const auto model = bench::sphere_model<V>(bench::the_scene());
  ask(state, model, clearance::point_span(bench::the_scene().cloud), How);
}
template <class V, kind How>
void triangles(benchmark::State& state) {
  static const auto model = bench::triangle_model<V>(bench::the_scene());
  ask(state, model, clearance::point_span(bench::the_scene().cloud), How);
}

/// The frame as a depth camera sends it: 16-bit millimetres, deprojected as they are read.
template <kind How>
void depth(benchmark::State& state) {
  static const auto model = bench::sphere_model<clearance::sphere>(bench::the_scene());
  static const std::vector<std::uint16_t> pixels = [] {
    std::vector<std::uint16_t> all;
    for (const auto& p : bench::the_scene().cloud)
      all.push_back(clearance::is_finite(p) ? std::uint16_t(p.z * 1000 + 0.5f) : 0);
    return all;
  }();
  ask(state, model, clearance::depth_image<std::uint16_t>(pixels.data(), 640, 480, {525, 525, 319.5, 239.5}), How);
}

template <bench::scene (*Make)(const bench::scene&), kind How>
void crowd(benchmark::State& state) {
  static const bench::scene s = Make(bench::the_scene());
  static const auto model = bench::sphere_model<clearance::sphere>(s);
  ask(state, model, clearance::point_span(s.cloud), How, s);
}

/// The time to read the points: their sum, in vector code.
void read(benchmark::State& state) {
  const auto& cloud = bench::the_scene().cloud;
  const float* const f = &cloud[0].x;
  constexpr std::size_t lanes = 32;
  float sums[lanes] = {};
  for (auto _ : state) {
    for (std::size_t i = 0; i + lanes <= 3 * cloud.size(); i += lanes)
      for (std::size_t j = 0; j < lanes; ++j) sums[j] += f[i + j];
    benchmark::DoNotOptimize(sums);
  }
}

#define ON_THREADS ->Arg(1)->Arg(2)->ArgName("threads")->UseRealTime()->Unit(benchmark::kMillisecond)
BENCHMARK(read)->Unit(benchmark::kMillisecond);
BENCHMARK(spheres<clearance::sphere, warm>) ON_THREADS;
BENCHMARK(spheres<clearance::sphere, cold>) ON_THREADS;
BENCHMARK(spheres<clearance::sphere, plain>) ON_THREADS;
BENCHMARK(spheres<clearance::sphere, parts>) ON_THREADS;
BENCHMARK(spheres<clearance::aabb, warm>) ON_THREADS;
BENCHMARK(spheres<clearance::obb, warm>) ON_THREADS;
BENCHMARK(depth<warm>) ON_THREADS;
BENCHMARK(depth<cold>) ON_THREADS;
BENCHMARK(triangles<clearance::sphere, warm>) ON_THREADS;
BENCHMARK(triangles<clearance::aabb, warm>) ON_THREADS;
BENCHMARK(triangles<clearance::aabb, cold>) ON_THREADS;
BENCHMARK(triangles<clearance::aabb, plain>) ON_THREADS;
BENCHMARK(triangles<clearance::aabb, parts>) ON_THREADS;
BENCHMARK(triangles<clearance::obb, warm>) ON_THREADS;
BENCHMARK(crowd<bench::sixty_four_parts, warm>) ON_THREADS;
BENCHMARK(crowd<bench::sixty_four_parts, cold>) ON_THREADS;
BENCHMARK(crowd<bench::sixty_four_parts, parts>) ON_THREADS;
BENCHMARK(crowd<bench::two_robots, warm>) ON_THREADS;
BENCHMARK(crowd<bench::two_robots, cold>) ON_THREADS;
BENCHMARK(crowd<bench::one_large_part, warm>) ON_THREADS;
BENCHMARK(crowd<bench::one_large_part, cold>) ON_THREADS;

}  // namespace
}  // namespace min_distance_bench

BENCHMARK_MAIN();
