// SPDX-License-Identifier: BSD-3-Clause
// Every point's own distance on the CPU: one frame of 307,200 pixels and the whole robot, in the frame's order or
// random order, and with part and primitive.
#include "scene.hpp"

#include <clearance/questions/distances.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>

namespace distances_bench {
namespace {

enum order { as_it_comes, random_order };

template <class Model>
void ask(benchmark::State& state, const Model& model, float d_max, bool which, order by) {
  const bench::scene& s = bench::the_scene();
  auto points = s.cloud;
  if (by == random_order) std::shuffle(points.begin(), points.end(), std::mt19937(5));
  const clearance::host cpu{.threads = unsigned(state.range(0))};
  const clearance::placed cloud{clearance::point_span(points), s.world_from_camera};
  std::vector<float> distance(points.size());
  std::vector<std::uint32_t> part(which ? points.size() : 0), primitive(part.size());
  const clearance::distances_out out{distance.data(), which ? part.data() : nullptr,
                                     which ? primitive.data() : nullptr};
  clearance::point_counts counts;
  for (auto _ : state) clearance::enqueue(cpu, model, s.poses, cloud, clearance::distances{d_max}, {out, &counts});
  double sum = 0;
  std::size_t near = 0;
  for (const float d : distance)
    if (d < clearance::infinity) sum += d, ++near;
  state.counters["near"] = double(near);
  state.counters["mean_mm"] = 1e3 * sum / double(near);
}

using clearance::sphere, clearance::aabb, clearance::obb;

template <class V>
const auto spheres = [](benchmark::State& state, float d_max, bool which = false, order by = as_it_comes) {
  static const auto model = bench::sphere_model<V>(bench::the_scene());
  ask(state, model, d_max, which, by);
};
template <class V>
const auto triangles = [](benchmark::State& state, float d_max, bool which = false, order by = as_it_comes) {
  static const auto model = bench::triangle_model<V>(bench::the_scene());
  ask(state, model, d_max, which, by);
};

constexpr float all = clearance::infinity;

const int rows = [] {
  const auto add = [](const char* name, const auto& what, auto... how) {
    benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { what(state, how...); })
        ->Arg(1)
        ->Arg(0)
        ->ArgName("threads")
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
  };
  add("spheres<sphere>", spheres<sphere>, all);
  add("spheres<sphere>, which", spheres<sphere>, all, true);
  add("spheres<sphere>, random order", spheres<sphere>, all, false, random_order);
  add("spheres<sphere>, within 10 cm", spheres<sphere>, 0.1f);
  add("spheres<aabb>", spheres<aabb>, all);
  add("spheres<obb>", spheres<obb>, all);
  add("triangles<aabb>", triangles<aabb>, all);
  add("triangles<aabb>, which", triangles<aabb>, all, true);
  add("triangles<aabb>, random order", triangles<aabb>, all, false, random_order);
  add("triangles<aabb>, within 10 cm", triangles<aabb>, 0.1f);
  add("triangles<sphere>", triangles<sphere>, all);
  add("triangles<obb>", triangles<obb>, all);
  return 0;
}();

}  // namespace
}  // namespace distances_bench

BENCHMARK_MAIN();
