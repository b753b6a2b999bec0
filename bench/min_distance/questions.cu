// SPDX-License-Identifier: BSD-3-Clause
// Questions about pairs on a GPU that holds the points: zones, the points within a distance, whether there is one, and
// which are the robot's own; and, to compare, every part's minimum. *close*: from close_camera(); *fields*, *cells*: of
// a robot whose parts have them, for kernels that look into them (those of in_collision and of labels look into no
// cells). CUDA events, behind other work.
#include "device.cuh"
#include "tables.cuh"

#include <clearance/device.cuh>
#include <clearance/frames/mapped_clouds.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

namespace questions_bench {
namespace {

using namespace bench;
using clearance::device, clearance::vec3, clearance::pair_distance, clearance::point_counts;
namespace pairwise = clearance::pairwise;

/// The robot and the frame on the GPU.
template <class Model>
struct question {
  const scene& s = the_scene();
  device gpu;
  const Model& model;
  clearance::device_buffer<vec3> points;
  clearance::placed<clearance::point_span> cloud;
  clearance::device_buffer<point_counts> counts{1, gpu.id};
  clearance::device_buffer<std::uint32_t> first_point =
      gpu.copy_in(std::span<const std::uint32_t>(std::vector<std::uint32_t>{0}));
  device_clock clock{true};

  question(const benchmark::State& state, bool close, const Model& its)
      : model(its),
        points(gpu.copy_in(std::span<const vec3>(repeated(s.cloud, std::size_t(state.range(0)))))),
        cloud{clearance::point_span(points.data(), points.size()), close ? close_camera() : s.world_from_camera} {}

  template <class T>
  clearance::device_buffer<T> of_parts(std::size_t each, const std::vector<T>& values) const {
    std::vector<T> all;
    for (std::size_t k = 0; k < model.size(); ++k)
      for (std::size_t z = 0; z < each; ++z) all.push_back(values[z]);
    return gpu.copy_in(std::span<const T>(all));
  }

  /// Resets `words` and asks, again and again.
  template <class Answer, class T>
  void ask(benchmark::State& state, const Answer& answer, const clearance::device_buffer<T>& words,
           const std::vector<T>& fresh) {
    pairwise::device_pairs<typename Model::view_type> query(gpu, model.view());
    const auto start = gpu.copy_in(std::span<const T>(fresh));
    const auto frame = [&] {
      clearance::check_cuda(
          cudaMemcpyAsync(words.data(), start.data(), words.size() * sizeof(T), cudaMemcpyDeviceToDevice),
          "cudaMemcpyAsync");
      query.enqueue(s.poses, cloud, answer, counts.data(), clearance::frames::as_it_is{});
    };
    frame();
    for (auto _ : state) state.SetIterationTime(clock.seconds(frame));
  }
};

template <class F>
void with_question(const benchmark::State& state, bool close, tables its, const F& f) {
  with_tables(device{}, sphere_model<clearance::sphere>(the_scene()), its, [&](const auto& model) {
    question<std::remove_cvref_t<decltype(model)>> q(state, close, model);
    f(q);
  });
}

void zones(benchmark::State& state, bool close, tables its) {
  if (no_device(state)) return;
  with_question(state, close, its, [&](auto& q) {
    const auto reaches = q.template of_parts<float>(3, {0.1f, 0.2f, 0.4f});
    const std::vector<pairwise::zone_words> fresh(pairwise::count_in_zones::copies * reaches.size());
    const auto words = q.gpu.copy_in(std::span<const pairwise::zone_words>(fresh));
    q.ask(
        state,
        pairwise::count_in_zones{words.data(), reaches.data(), q.first_point.data(), 3, std::uint32_t(reaches.size())},
        words, fresh);
    double pairs = 0;
    for (const auto& w : q.gpu.copy_out(words)) pairs += double(w.points);
    state.counters["pairs"] = pairs;
  });
}

void within(benchmark::State& state, float radius, bool close, tables its) {
  if (no_device(state)) return;
  with_question(state, close, its, [&](auto& q) {
    const auto reaches = q.template of_parts<float>(1, {radius});
    const std::vector<unsigned long long> fresh(1);
    const auto count = q.gpu.copy_in(std::span<const unsigned long long>(fresh));
    const clearance::device_buffer<pair_distance> pairs(q.points.size(), q.gpu.id);
    q.ask(state, pairwise::listed{pairs.data(), count.data(), pairs.size(), reaches.data()}, count, fresh);
    state.counters["pairs"] = double(q.gpu.copy_out(count)[0]);
  });
}

void in_collision(benchmark::State& state, float margin, tables its) {
  if (no_device(state)) return;
  with_question(state, false, its, [&](auto& q) {
    const auto reaches = q.template of_parts<float>(1, {margin});
    const std::vector fresh{pairwise::first_within::nothing};
    const auto word = q.gpu.copy_in(std::span<const unsigned long long>(fresh));
    q.ask(state, pairwise::first_within{word.data(), reaches.data(), reaches.data(), q.first_point.data()}, word,
          fresh);
    state.counters["found"] = q.gpu.copy_out(word)[0] != pairwise::first_within::nothing;
  });
}

void every_part(benchmark::State& state) {
  if (no_device(state)) return;
  with_question(state, false, tables{}, [&](auto& q) {
    clearance::query query(q.gpu, q.model, clearance::min_distance_per_part{});
    const clearance::device_buffer<clearance::min_distance_result> result(1, q.gpu.id);
    const clearance::device_buffer<clearance::part_minimum> minima(q.model.size(), q.gpu.id);
    const auto frame = [&] { query.enqueue(q.s.poses, q.cloud, {result.data(), minima.data()}); };
    frame();
    for (auto _ : state) state.SetIterationTime(q.clock.seconds(frame));
  });
}

/// Which points are the robot's own; afterwards, if `minimum`, the least distance of the others.
void own(benchmark::State& state, bool minimum, bool prepared, tables its) {
  if (no_device(state)) return;
  with_question(state, true, its, [&](auto& q) {
    clearance::query query(q.gpu, q.model, clearance::min_distance{});
    const clearance::device_buffer<clearance::point_label> labels(q.points.size(), q.gpu.id);
    const clearance::device_buffer<clearance::self_filter_counts> counts(1, q.gpu.id);
    const clearance::device_buffer<clearance::min_distance_result> result(1, q.gpu.id);
    const auto rest = clearance::masked_clouds(q.cloud, labels.data());
    clearance::query filter(q.gpu, q.model, clearance::self_filter{});
    const auto frame = [&] {
      if (prepared)
        filter.enqueue(q.s.poses, q.cloud, {.padding = {0.05}}, {labels.data(), counts.data()});
      else
        clearance::enqueue(q.gpu, q.model, q.s.poses, q.cloud, clearance::self_filter{.padding = {0.05}},
                           {labels.data(), counts.data()});
      if (minimum) query.enqueue(q.s.poses, rest, result.data());
    };
    frame();
    for (auto _ : state) state.SetIterationTime(q.clock.seconds(frame));
    state.counters["own"] = double(q.gpu.copy_out(counts)[0].own);
  });
}

void one_minimum(benchmark::State& state) {
  if (no_device(state)) return;
  with_question(state, true, tables{}, [&](auto& q) {
    clearance::query query(q.gpu, q.model, clearance::min_distance{});
    const clearance::device_buffer<clearance::min_distance_result> result(1, q.gpu.id);
    const auto frame = [&] { query.enqueue(q.s.poses, q.cloud, result.data()); };
    frame();
    for (auto _ : state) state.SetIterationTime(q.clock.seconds(frame));
  });
}

constexpr tables bare{}, fields{.fields = true}, cells{.cells = true}, both{.fields = true, .cells = true};
#define TIMES ->Arg(307200)->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(50)
BENCHMARK(every_part) TIMES;
BENCHMARK(one_minimum) TIMES;
BENCHMARK_CAPTURE(zones, of_10_20_40cm, false, bare) TIMES;
BENCHMARK_CAPTURE(zones, of_10_20_40cm_fields, false, fields) TIMES;
BENCHMARK_CAPTURE(zones, of_10_20_40cm_cells, false, cells) TIMES;
BENCHMARK_CAPTURE(zones, of_10_20_40cm_both, false, both) TIMES;
BENCHMARK_CAPTURE(zones, close, true, bare) TIMES;
BENCHMARK_CAPTURE(zones, close_fields, true, fields) TIMES;
BENCHMARK_CAPTURE(zones, close_cells, true, cells) TIMES;
BENCHMARK_CAPTURE(zones, close_both, true, both) TIMES;
BENCHMARK_CAPTURE(within, 10cm, 0.1f, false, bare) TIMES;
BENCHMARK_CAPTURE(within, 10cm_fields, 0.1f, false, fields) TIMES;
BENCHMARK_CAPTURE(within, 10cm_cells, 0.1f, false, cells) TIMES;
BENCHMARK_CAPTURE(within, 10cm_both, 0.1f, false, both) TIMES;
BENCHMARK_CAPTURE(within, 15cm, 0.15f, false, bare) TIMES;
BENCHMARK_CAPTURE(within, 15cm_fields, 0.15f, false, fields) TIMES;
BENCHMARK_CAPTURE(within, 15cm_cells, 0.15f, false, cells) TIMES;
BENCHMARK_CAPTURE(within, 15cm_both, 0.15f, false, both) TIMES;
BENCHMARK_CAPTURE(within, 8.24cm_close, 0.0824f, true, bare) TIMES;  // 20,000 pairs of 307,200 points
BENCHMARK_CAPTURE(within, 8.24cm_close_fields, 0.0824f, true, fields) TIMES;
BENCHMARK_CAPTURE(within, 8.24cm_close_cells, 0.0824f, true, cells) TIMES;
BENCHMARK_CAPTURE(within, 8.24cm_close_both, 0.0824f, true, both) TIMES;
BENCHMARK_CAPTURE(within, 10cm_close, 0.1f, true, bare) TIMES;
BENCHMARK_CAPTURE(within, 10cm_close_fields, 0.1f, true, fields) TIMES;
BENCHMARK_CAPTURE(within, 10cm_close_cells, 0.1f, true, cells) TIMES;
BENCHMARK_CAPTURE(within, 10cm_close_both, 0.1f, true, both) TIMES;
BENCHMARK_CAPTURE(in_collision, within_5cm, 0.05f, bare) TIMES;
BENCHMARK_CAPTURE(in_collision, within_5cm_fields, 0.05f, fields) TIMES;
BENCHMARK_CAPTURE(in_collision, within_10cm, 0.1f, bare) TIMES;
BENCHMARK_CAPTURE(in_collision, within_10cm_fields, 0.1f, fields) TIMES;
BENCHMARK_CAPTURE(own, labels, false, true, bare) TIMES;
BENCHMARK_CAPTURE(own, labels_fields, false, true, fields) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum, true, true, bare) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum_fields, true, true, fields) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum_cells, true, true, cells) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum_both, true, true, both) TIMES;
BENCHMARK_CAPTURE(own, labels_at_once, false, false, bare) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum_at_once, true, false, bare) TIMES;

}  // namespace
}  // namespace questions_bench

#undef TIMES

BENCHMARK_MAIN();
