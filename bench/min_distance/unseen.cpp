// SPDX-License-Identifier: BSD-3-Clause
// What one 640 x 480 frame hides up to 5 m, on the CPU, beside the minimum to what it shows, and both. *silent*: pixels
// that return nothing hide room from 0.4 m on, and the robot reaches into it. *certain*: what is certain of the minimum
// in spite of a stereo camera's noise.
#include "unseen.hpp"

namespace unseen_bench {
namespace {

template <class Model, class Question>
void ask(benchmark::State& state, const Model& model, const Question& q, bool silent) {
  const bench::scene& s = bench::the_scene();
  const auto pixels = silent ? bench::depths_of(s) : bench::set_back(bench::depths_of(s));
  const clearance::placed image{bench::seen_for<Question>(bench::image_of(pixels.data())), s.world_from_camera};
  clearance::query query(clearance::host{.threads = 1}, model, q);
  for (auto _ : state) {
    const auto& r = query(s.poses, image);
    state.counters["distance_mm"] = bench::least_of(r) * 1e3;
  }
}

const int rows = bench::add_rows([](auto&... all) { ask(all...); },
                                 [](benchmark::internal::Benchmark* row) {
                                   row->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
                                 });

}  // namespace
}  // namespace unseen_bench

BENCHMARK_MAIN();
