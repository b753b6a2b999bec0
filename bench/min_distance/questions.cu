// SPDX-License-Identifier: BSD-3-Clause
// Questions about pairs on a GPU that holds the points: zones, the points within a distance, whether there is one, and
// which are the robot's own; and, to compare, every part's minimum. *close*: from close_camera(); *fields*: of a robot
// whose parts have them. CUDA events, behind other work.
#include "device.cuh"

#include <clearance/device.cuh>
#include <clearance/fields.hpp>
#include <clearance/frame/masked_clouds.hpp>
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

auto model_there(const device& gpu, bool fields) {
  auto model = sphere_model<clearance::sphere>(the_scene());
  return (fields ? clearance::with_fields(gpu, std::move(model)).model : std::move(model)).on(gpu);
}
using model_on_gpu = decltype(model_there(device{}, false));

/// The robot and the frame on the GPU.
struct question {
  const scene& s = the_scene();
  device gpu;
  model_on_gpu model;
  clearance::device_buffer<vec3> points;
  clearance::placed<clearance::point_span> cloud;
  clearance::device_buffer<point_counts> counts{1, gpu.id};
  clearance::device_buffer<std::uint32_t> first_point =
      gpu.copy_in(std::span<const std::uint32_t>(std::vector<std::uint32_t>{0}));
  device_clock clock{true};

  explicit question(const benchmark::State& state, bool close = false, bool fields = false)
      : model(model_there(gpu, fields)),
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
    pairwise::device_pairs<model_on_gpu::view_type> query(gpu, model.view());
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

void zones(benchmark::State& state, bool close, bool fields) {
  if (no_device(state)) return;
  question q(state, close, fields);
  const auto reaches = q.of_parts<float>(3, {0.1f, 0.2f, 0.4f});
  const std::vector<pairwise::zone_words> fresh(pairwise::count_in_zones::copies * reaches.size());
  const auto words = q.gpu.copy_in(std::span<const pairwise::zone_words>(fresh));
  q.ask(state,
        pairwise::count_in_zones{words.data(), reaches.data(), q.first_point.data(), 3, std::uint32_t(reaches.size())},
        words, fresh);
  double pairs = 0;
  for (const auto& w : q.gpu.copy_out(words)) pairs += double(w.points);
  state.counters["pairs"] = pairs;
}

void within(benchmark::State& state, float radius, bool close, bool fields) {
  if (no_device(state)) return;
  question q(state, close, fields);
  const auto reaches = q.of_parts<float>(1, {radius});
  const std::vector<unsigned long long> fresh(1);
  const auto count = q.gpu.copy_in(std::span<const unsigned long long>(fresh));
  const clearance::device_buffer<pair_distance> pairs(q.points.size(), q.gpu.id);
  q.ask(state, pairwise::listed{pairs.data(), count.data(), pairs.size(), reaches.data()}, count, fresh);
  state.counters["pairs"] = double(q.gpu.copy_out(count)[0]);
}

void in_collision(benchmark::State& state, float margin, bool fields) {
  if (no_device(state)) return;
  question q(state, false, fields);
  const auto reaches = q.of_parts<float>(1, {margin});
  const std::vector fresh{pairwise::first_within::nothing};
  const auto word = q.gpu.copy_in(std::span<const unsigned long long>(fresh));
  q.ask(state, pairwise::first_within{word.data(), reaches.data(), reaches.data(), q.first_point.data()}, word, fresh);
  state.counters["found"] = q.gpu.copy_out(word)[0] != pairwise::first_within::nothing;
}

void every_part(benchmark::State& state) {
  if (no_device(state)) return;
  question q(state);
  clearance::query query(q.gpu, q.model, clearance::min_distance_per_part{});
  const clearance::device_buffer<clearance::min_distance_result> result(1, q.gpu.id);
  const clearance::device_buffer<clearance::part_minimum> minima(q.model.size(), q.gpu.id);
  const auto frame = [&] { query.enqueue(q.s.poses, q.cloud, {result.data(), minima.data()}); };
  frame();
  for (auto _ : state) state.SetIterationTime(q.clock.seconds(frame));
}

/// Which points are the robot's own; afterwards, if `minimum`, the least distance of the others.
void own(benchmark::State& state, bool minimum, bool prepared, bool fields) {
  if (no_device(state)) return;
  question q(state, true, fields);
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
}

void one_minimum(benchmark::State& state) {
  if (no_device(state)) return;
  question q(state, true);
  clearance::query query(q.gpu, q.model, clearance::min_distance{});
  const clearance::device_buffer<clearance::min_distance_result> result(1, q.gpu.id);
  const auto frame = [&] { query.enqueue(q.s.poses, q.cloud, result.data()); };
  frame();
  for (auto _ : state) state.SetIterationTime(q.clock.seconds(frame));
}

#define TIMES ->Arg(307200)->Arg(5000000)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(50)
BENCHMARK(every_part) TIMES;
BENCHMARK(one_minimum) TIMES;
BENCHMARK_CAPTURE(zones, of_10_20_40cm, false, false) TIMES;
BENCHMARK_CAPTURE(zones, of_10_20_40cm_fields, false, true) TIMES;
BENCHMARK_CAPTURE(zones, close, true, false) TIMES;
BENCHMARK_CAPTURE(zones, close_fields, true, true) TIMES;
BENCHMARK_CAPTURE(within, 10cm, 0.1f, false, false) TIMES;
BENCHMARK_CAPTURE(within, 10cm_fields, 0.1f, false, true) TIMES;
BENCHMARK_CAPTURE(within, 15cm, 0.15f, false, false) TIMES;
BENCHMARK_CAPTURE(within, 15cm_fields, 0.15f, false, true) TIMES;
BENCHMARK_CAPTURE(within, 8.24cm_close, 0.0824f, true, false) TIMES;  // 20,000 pairs of 307,200 points
BENCHMARK_CAPTURE(within, 8.24cm_close_fields, 0.0824f, true, true) TIMES;
BENCHMARK_CAPTURE(within, 10cm_close, 0.1f, true, false) TIMES;
BENCHMARK_CAPTURE(within, 10cm_close_fields, 0.1f, true, true) TIMES;
BENCHMARK_CAPTURE(in_collision, within_5cm, 0.05f, false) TIMES;
BENCHMARK_CAPTURE(in_collision, within_5cm_fields, 0.05f, true) TIMES;
BENCHMARK_CAPTURE(in_collision, within_10cm, 0.1f, false) TIMES;
BENCHMARK_CAPTURE(in_collision, within_10cm_fields, 0.1f, true) TIMES;
BENCHMARK_CAPTURE(own, labels, false, true, false) TIMES;
BENCHMARK_CAPTURE(own, labels_fields, false, true, true) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum, true, true, false) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum_fields, true, true, true) TIMES;
BENCHMARK_CAPTURE(own, labels_at_once, false, false, false) TIMES;
BENCHMARK_CAPTURE(own, labels_then_minimum_at_once, true, false, false) TIMES;

}  // namespace
}  // namespace questions_bench

#undef TIMES

BENCHMARK_MAIN();
