// SPDX-License-Identifier: BSD-3-Clause
// What one 640 x 480 frame on a GPU hides up to 5 m, beside the minimum to what it shows, and both. *silent*: pixels
// that return nothing hide room from 0.4 m on, and the robot reaches into it. One call as in a program, by the host's
// clock.
#include "device.cuh"
#include "unseen.hpp"

namespace unseen_bench {
namespace {

template <class Model, class Question>
void ask(benchmark::State& state, const Model& model, const Question& q, bool silent) {
  if (bench::no_device(state)) return;
  const bench::scene& s = bench::the_scene();
  const clearance::device gpu;
  const auto there = model.on(gpu);
  const auto pixels = silent ? bench::depths_of(s) : bench::set_back(bench::depths_of(s));
  const auto resident = gpu.copy_in(std::span<const std::uint16_t>(pixels));
  const clearance::placed image{bench::seen_for<Question>(bench::image_of(resident.data())), s.world_from_camera};
  clearance::query query(gpu, there, q);
  bench::percentiles(state, 300, [&](std::size_t) {
    const auto& r = query(s.poses, image);
    state.counters["distance_mm"] = bench::least_of(r) * 1e3;
  });
}

const int rows = bench::add_rows(
    [](auto&... all) { ask(all...); },
    [](benchmark::internal::Benchmark* row) { row->UseManualTime()->Iterations(1)->Unit(benchmark::kMicrosecond); });

}  // namespace
}  // namespace unseen_bench

BENCHMARK_MAIN();
