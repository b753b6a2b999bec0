// SPDX-License-Identifier: BSD-3-Clause
// What one 640 x 480 frame on a GPU hides up to 5 m, beside every part's minimum to what it shows. *silent*: pixels
// that return nothing hide room from 0.4 m on, and the robot reaches into it. One call as in a program, by the host's
// clock.
#include "device.cuh"
#include "unseen.hpp"

#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

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

template <class Question>
void spheres(benchmark::State& state, const Question& q, bool silent) {
  static const auto model = bench::sphere_model<clearance::sphere>(bench::the_scene());
  ask(state, model, q, silent);
}
template <class Question>
void triangles(benchmark::State& state, const Question& q, bool silent) {
  static const auto model = bench::triangle_model<clearance::aabb>(bench::the_scene());
  ask(state, model, q, silent);
}

#define TIMES ->UseManualTime()->Iterations(1)->Unit(benchmark::kMicrosecond)
#define BOTH(name, ...)                                \
  BENCHMARK_CAPTURE(spheres, name, __VA_ARGS__) TIMES; \
  BENCHMARK_CAPTURE(triangles, name, __VA_ARGS__) TIMES
BOTH(parts, clearance::min_distance_per_part{}, false);
BOTH(unseen, bench::hidden_to_5m, false);
BOTH(unseen_silent, bench::hidden_to_5m, true);
BOTH(certain, clearance::certain_distance{}, false);

}  // namespace
}  // namespace unseen_bench

BENCHMARK_MAIN();
