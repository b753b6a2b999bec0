// SPDX-License-Identifier: BSD-3-Clause
// Many configurations and one frame of 307,200 points on the CPU, including the tree over the points: random ones, in
// full or up to 5 cm, and a trajectory that is watched from frame to frame. *each* asks a prepared min_distance for one
// after another.
#include "configurations.hpp"

#include <clearance/near_maps.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <benchmark/benchmark.h>

namespace configurations_bench {
namespace {

using clearance::placed, clearance::point_span;

const auto& spheres() {
  static const auto model = bench::sphere_model<clearance::sphere>(bench::the_scene());
  return model;
}
const auto& triangles() {
  static const auto model = bench::triangle_model<clearance::aabb>(bench::the_scene());
  return model;
}
const auto& spheres_field() {
  static const auto model = clearance::with_fields(clearance::host{}, spheres()).model;
  return model;
}
const auto& triangles_field() {
  static const auto model = clearance::with_fields(clearance::host{}, triangles()).model;
  return model;
}

void report(benchmark::State& state, const clearance::min_distances_result& found) {
  double free = 0, near = 0;
  for (const auto& r : found.of) free += r.state == clearance::state::free, near += r.part != clearance::none;
  state.counters["free"] = free, state.counters["minima"] = near;
}

template <class Model>
void random(benchmark::State& state, const Model& (*model)(), float d_max) {
  const bench::scene& s = bench::the_scene();
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const auto poses = bench::random_configurations(std::size_t(state.range(1)));
  const placed cloud{point_span(s.cloud), s.world_from_camera};
  const Model& robot = model();
  clearance::min_distances_result found;
  for (auto _ : state) found = clearance::ask(cpu, robot, poses, cloud, clearance::min_distances{d_max});
  report(state, found);
}

void each_part(benchmark::State& state) {
  const bench::scene& s = bench::the_scene();
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const auto poses = bench::random_configurations(std::size_t(state.range(1)));
  clearance::min_distances_result found;
  for (auto _ : state)
    found.of = clearance::ask(cpu, spheres(), poses, placed{point_span(s.cloud), s.world_from_camera},
                              clearance::min_distances_per_part{})
                   .all;
  report(state, found);
}

template <class Model>
void monitor(benchmark::State& state, const Model& (*model)()) {
  const bench::scene& s = bench::the_scene();
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const auto poses = bench::trajectory(std::size_t(state.range(1)));
  const std::vector<clearance::vec3> frames[] = {bench::next_frame(s.cloud, 1), bench::next_frame(s.cloud, 2)};
  clearance::query query(cpu, model(), clearance::min_distances{});
  std::size_t n = 0;
  const clearance::min_distances_result* found = &query(poses, placed{point_span(frames[1]), s.world_from_camera});
  for (auto _ : state) found = &query(poses, placed{point_span(frames[n++ % 2]), s.world_from_camera});
  report(state, *found);
}

/// The fields of all parts, sampled.
template <class Model>
void sample(benchmark::State& state, const Model& (*model)()) {
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const Model& robot = model();
  for (auto _ : state) {
    const auto fielded = clearance::with_fields(cpu, robot).model;
    benchmark::DoNotOptimize(fielded.view());
  }
}

void each(benchmark::State& state) {
  const bench::scene& s = bench::the_scene();
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const auto poses = bench::random_configurations(std::size_t(state.range(1)));
  clearance::query query(cpu, spheres(), clearance::min_distance{});
  clearance::min_distances_result found;
  const std::size_t parts = s.poses.size();
  for (auto _ : state) {
    found.of.clear();
    for (std::size_t c = 0; c < poses.size(); c += parts)
      found.of.push_back(query(std::span(poses).subspan(c, parts), point_span(s.cloud), s.world_from_camera));
  }
  report(state, found);
}

constexpr float all = clearance::infinity;
#define TIMES(n) \
  ->Args({1, n})->Args({2, n})->ArgNames({"threads", "configurations"})->UseRealTime()->Unit(benchmark::kMillisecond)
BENCHMARK_CAPTURE(random, spheres, spheres, all) TIMES(1000);
BENCHMARK_CAPTURE(random, spheres_by_field, spheres_field, all) TIMES(1000);
BENCHMARK_CAPTURE(random, spheres_within_5cm, spheres, 0.05f) TIMES(1000);
BENCHMARK_CAPTURE(random, spheres_within_5cm_by_field, spheres_field, 0.05f) TIMES(1000);
BENCHMARK_CAPTURE(random, triangles, triangles, all) TIMES(1000);
BENCHMARK_CAPTURE(random, triangles_by_field, triangles_field, all) TIMES(1000);
BENCHMARK_CAPTURE(random, triangles_within_5cm, triangles, 0.05f) TIMES(1000);
BENCHMARK_CAPTURE(random, triangles_within_5cm_by_field, triangles_field, 0.05f) TIMES(1000);
BENCHMARK_CAPTURE(random, tree_alone, spheres, 0.0f) TIMES(1);
BENCHMARK(each_part) TIMES(1000);
BENCHMARK_CAPTURE(monitor, spheres, spheres) TIMES(500);
BENCHMARK_CAPTURE(monitor, spheres_by_field, spheres_field) TIMES(500);
BENCHMARK(each) TIMES(100);
BENCHMARK_CAPTURE(sample, spheres, spheres) TIMES(0)->Iterations(1);
BENCHMARK_CAPTURE(sample, triangles, triangles) TIMES(0)->Iterations(1);

}  // namespace
}  // namespace configurations_bench

#undef TIMES

BENCHMARK_MAIN();
