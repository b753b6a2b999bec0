// SPDX-License-Identifier: BSD-3-Clause
// A least distance with a deadline, on a GPU with points there or in host memory, and on the host: how much is seen,
// and how late it is, by the host's clock. A deadline of 0 us means none: the time for all pieces.
#include "device.cuh"

#include <clearance/deadline.hpp>
#include <clearance/device.cuh>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>

namespace deadline_bench {
namespace {

using namespace bench;
using clearance::device, clearance::vec3;

/// 300 calls. Counters: `seen` is the part of all points in the median call; the others say how many microseconds after
/// the deadline calls returned.
template <class On, class Model>
void ask(benchmark::State& state, const On& on, const Model& model, const clearance::point_span& points) {
  const scene& s = the_scene<false>();
  const clearance::placed cloud{points, s.world_from_camera};
  const double us = double(state.range(1));
  const std::chrono::duration<double> deadline{us == 0 ? clearance::infinity : us * 1e-6};
  clearance::query query(on, model, clearance::min_distance{});
  std::vector<double> late, seen, took;
  for (auto _ : state) {
    for (int k = 0; k < 320; ++k) {
      const auto start = std::chrono::steady_clock::now();
      const auto r = clearance::ask_by(query, s.poses, cloud, deadline, clearance::min_distance{});
      const double its = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
      if (k < 20) continue;
      took.push_back(its), late.push_back(its - us),
          seen.push_back(double(r.result.seen) / double(r.result.seen + r.unseen));
    }
  }
  for (auto* all : {&took, &late, &seen}) std::sort(all->begin(), all->end());
  const auto at = [](const std::vector<double>& all, double part) {
    return all[std::size_t(part * double(all.size() - 1))];
  };
  state.SetIterationTime(at(took, 0.5) * 1e-6);
  state.counters["seen"] = at(seen, 0.5);
  if (us != 0)
    state.counters["late_us"] = at(late, 0.5), state.counters["late_p99_us"] = at(late, 0.99),
    state.counters["late_max_us"] = late.back();
}

enum where { there, pinned_here, here };

void on_device(benchmark::State& state, where memory) {
  if (no_device(state)) return;
  const device gpu;
  const auto model = triangle_model<clearance::aabb>(the_scene<false>()).on(gpu);
  const auto& points = repeated(the_scene<false>().cloud, std::size_t(state.range(0)));
  if (memory == here) return ask(state, gpu, model, clearance::point_span(points));
  if (memory == pinned_here) {
    const auto copy = pinned(points, gpu);
    return ask(state, gpu, model, clearance::point_span(copy.data(), points.size()));
  }
  const auto copy = gpu.copy_in(std::span<const vec3>(points));
  ask(state, gpu, model, clearance::point_span(copy.data(), points.size()));
}
void on_host(benchmark::State& state) {
  static const auto model = triangle_model<clearance::aabb>(the_scene<false>());
  ask(state, clearance::host{1}, model,
      clearance::point_span(repeated(the_scene<false>().cloud, std::size_t(state.range(0)))));
}

#define ONCE ->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(1)->ArgNames({"points", "deadline_us"})
BENCHMARK_CAPTURE(on_device, there, there)->ArgsProduct({{50000000}, {0, 50, 100, 200, 500}}) ONCE;
BENCHMARK_CAPTURE(on_device, pinned, pinned_here)->ArgsProduct({{5000000}, {0, 500, 1000}}) ONCE;
BENCHMARK_CAPTURE(on_device, pageable, here)->ArgsProduct({{5000000}, {0, 500, 1000}}) ONCE;
BENCHMARK(on_host)->ArgsProduct({{307200, 5000000}, {0, 100, 300, 1000}}) ONCE;

}  // namespace
}  // namespace deadline_bench

#undef ONCE

BENCHMARK_MAIN();
