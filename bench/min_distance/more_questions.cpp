// SPDX-License-Identifier: BSD-3-Clause
// Zones, lists, the nearest, confirmed points, motions and gradients on the CPU, with one thread and with all.
#include "more_questions.hpp"

#include <clearance/volume/sphere.hpp>

namespace more_questions_bench {
namespace {

const int rows = [] {
  bench::for_each_question([](const std::string& name, const auto& row) {
    if (name.ends_with(", one call")) return;  // on the CPU, preparing only allocates
    benchmark::RegisterBenchmark(name.c_str(),
                                 [row](benchmark::State& state) {
                                   const bench::scene& s = bench::the_scene();
                                   static const auto model = bench::sphere_model<clearance::sphere>(s);
                                   row(state, clearance::host{.threads = unsigned(state.range(0))}, model,
                                       clearance::placed{clearance::point_span(s.cloud), s.world_from_camera});
                                 })
        ->Arg(1)
        ->Arg(0)
        ->ArgName("threads")
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
  });
  return 0;
}();

}  // namespace
}  // namespace more_questions_bench

BENCHMARK_MAIN();
