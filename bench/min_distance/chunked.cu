// SPDX-License-Identifier: BSD-3-Clause
// Clouds in chunks: 10^8 points from pinned, pageable and mapped memory through the ring to one GPU, and on the host,
// compared with copying, or reading, alone. The host's clock, medians. `first`: nothing is known about the cloud;
// `next`: its boxes are. Every answer is compared bit for bit with that about the whole cloud in memory.
#include "device.cuh"
#include "shell.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/device.cuh>
#include <clearance/io/mapped_cloud.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdlib>
#include <cstring>
#include <fstream>

namespace chunked_bench {
namespace {

using namespace bench;
using clearance::chunked, clearance::device, clearance::host, clearance::in_memory, clearance::point_span,
    clearance::vec3;

/// Each point is one of the frame's, up to 3.5 mm off along each axis.
const std::vector<vec3>& cloud(std::size_t count) {
  static std::map<std::size_t, std::vector<vec3>> made;
  std::vector<vec3>& points = made[count];
  if (!points.empty()) return points;
  points.resize(count);
  const auto& frame = the_scene().cloud;
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    const std::uint64_t bits = point_bits(i)();
    const auto off = [bits](int shift) { return (float(bits >> shift & 0x1fffff) * 0x1p-20f - 1) * 0.0035f; };
    points[i] = {frame[i % frame.size()].x + off(0), frame[i % frame.size()].y + off(21),
                 frame[i % frame.size()].z + off(42)};
  });
  return points;
}
const auto& robot() {
  static const auto model = sphere_model<clearance::sphere>(the_scene());
  return model;
}

/// Compares with the host's answer about the whole cloud, made once per count.
void same_bits(benchmark::State& state, const clearance::min_distance_result& r) {
  static std::map<std::int64_t, clearance::min_distance_result> known;
  const scene& s = the_scene();
  const auto at = known.find(state.range(0));
  const auto e = at != known.end()
                     ? at->second
                     : clearance::ask(host{}, robot(), s.poses, point_span(cloud(std::size_t(state.range(0)))),
                                      s.world_from_camera, clearance::min_distance{});
  known[state.range(0)] = e;
  const auto equal = [](const auto& a, const auto& b) { return std::memcmp(&a, &b, sizeof a) == 0; };
  if (!(r.state == e.state && equal(r.distance, e.distance) && equal(r.lower, e.lower) && equal(r.upper, e.upper) &&
        r.cloud == e.cloud && r.point == e.point && r.part == e.part && r.primitive == e.primitive &&
        equal(r.at, e.at) && equal(r.nearest, e.nearest) && equal(r.normal, e.normal) && r.seen == e.seen &&
        r.valid == e.valid && equal(r.dropped, e.dropped)))
    state.SkipWithError("another answer than about the whole");
}

template <class On, class C>
void ask(benchmark::State& state, const On& on, C source, bool next) {
  const auto model = robot().on(on);
  chunked in_chunks(std::move(source), std::size_t(state.range(1)));
  clearance::chunked_query query(on, model, clearance::min_distance{});
  const scene& s = the_scene();
  clearance::min_distance_result r;
  percentiles(
      state, 9, 2, [&](std::size_t) { r = query(s.poses, in_chunks, s.world_from_camera); },
      [&] {
        if (!next) in_chunks.forget();
      });
  state.counters["loaded"] = double(query.loaded());
  same_bits(state, r);
}

/// Pinned once, because the driver takes long.
const clearance::pinned_buffer<vec3>& pinned_cloud(std::size_t count) {
  static std::map<std::size_t, clearance::pinned_buffer<vec3>> made;
  auto& memory = made[count];
  if (memory.size() == 0) {
    memory = clearance::pinned_buffer<vec3>(count, 0);
    const auto& points = cloud(count);
    tbb::parallel_for(std::size_t(0), count / 65536 + 1, [&](std::size_t k) {
      const std::size_t from = k * 65536, to = std::min(count, from + 65536);
      if (from < to)
        std::copy(points.begin() + std::ptrdiff_t(from), points.begin() + std::ptrdiff_t(to), memory.data() + from);
    });
  }
  return memory;
}

void pinned(benchmark::State& state, bool next) {
  if (no_device(state)) return;
  const auto count = std::size_t(state.range(0));
  ask(state, device{}, in_memory{point_span(pinned_cloud(count).data(), count)}, next);
}
void pageable(benchmark::State& state, bool next) {
  if (no_device(state)) return;
  ask(state, device{}, in_memory{point_span(cloud(std::size_t(state.range(0))))}, next);
}
/// Copies the whole cloud once, and does nothing else.
void copy_alone(benchmark::State& state, bool from_pinned) {
  if (no_device(state)) return;
  const auto count = std::size_t(state.range(0));
  const vec3* from = from_pinned ? pinned_cloud(count).data() : cloud(count).data();
  const clearance::device_buffer<vec3> there(count, 0);
  percentiles(
      state, 9, 2,
      [&](std::size_t) {
        clearance::check_cuda(cudaMemcpy(there.data(), from, count * sizeof(vec3), cudaMemcpyHostToDevice),
                              "cudaMemcpy");
      },
      [] {});
}

void on_host(benchmark::State& state, bool next) {
  ask(state, host{}, in_memory{point_span(cloud(std::size_t(state.range(0))))}, next);
}
/// The whole cloud without chunks; nothing about it is kept.
void host_whole(benchmark::State& state) {
  const point_span points(cloud(std::size_t(state.range(0))));
  clearance::query query(host{}, robot(), clearance::min_distance{});
  const scene& s = the_scene();
  clearance::min_distance_result r;
  percentiles(
      state, 9, 2, [&](std::size_t) { r = query(s.poses, points, s.world_from_camera); }, [&] { query.forget(); });
  same_bits(state, r);
}
/// The least time that reading takes: all threads sum up every number.
double sum_of(const vec3* points, std::size_t count) {
  std::vector<double> sums(count / 65536 + 1);
  tbb::parallel_for(std::size_t(0), sums.size(), [&](std::size_t k) {
    const std::size_t from = k * 65536, to = std::min(count, from + 65536);
    float lanes[24] = {};
    const float* f = &points[from].x;
    std::size_t i = 0;
    for (; i + 24 <= (to - from) * 3; i += 24)
      for (std::size_t j = 0; j < 24; ++j) lanes[j] += f[i + j];
    for (const float l : lanes) sums[k] += l;
  });
  double all = 0;
  for (const double s : sums) all += s;
  return all;
}
void host_reads(benchmark::State& state) {
  const auto& points = cloud(std::size_t(state.range(0)));
  percentiles(state, 9, 2, [&](std::size_t) { benchmark::DoNotOptimize(sum_of(points.data(), points.size())); }, [] {});
}

/// A file in the folder CLEARANCE_SCRATCH (or /tmp), from the page cache.
struct scratch {
  std::string path;
  explicit scratch(const std::vector<vec3>& points) {
    const char* folder = std::getenv("CLEARANCE_SCRATCH");
    path = std::string(folder != nullptr ? folder : "/tmp") + "/clearance_bench.raw";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(points.data()), std::streamsize(points.size() * sizeof(vec3)));
  }
  ~scratch() { std::filesystem::remove(path); }
};
template <class On>
void mapped(benchmark::State& state, const On& on, bool next) {
  if constexpr (std::is_same_v<On, device>)
    if (no_device(state)) return;
  const scratch file(cloud(std::size_t(state.range(0))));
  ask(state, on, clearance::io::map_points(file.path), next);
}
/// A new mapping of the file in every call, as in a first question.
void mapped_reads(benchmark::State& state) {
  const scratch file(cloud(std::size_t(state.range(0))));
  percentiles(
      state, 9, 2,
      [&](std::size_t) {
        const auto there = clearance::io::map_points(file.path);
        benchmark::DoNotOptimize(sum_of(there.source.points, there.source.count));
      },
      [] {});
}

#define ONCE ->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(1)
#define LARGE ->Args({100000000, 1 << 22}) ONCE
BENCHMARK_CAPTURE(copy_alone, pinned, true) LARGE;
BENCHMARK_CAPTURE(pinned, first, false)->ArgsProduct({{100000000}, {1 << 18, 1 << 20, 1 << 22}}) ONCE;
BENCHMARK_CAPTURE(pinned, next, true) LARGE;
BENCHMARK_CAPTURE(copy_alone, pageable, false) LARGE;
BENCHMARK_CAPTURE(pageable, first, false)->ArgsProduct({{100000000}, {1 << 18, 1 << 20, 1 << 22}}) ONCE;
BENCHMARK_CAPTURE(pageable, next, true) LARGE;
BENCHMARK_CAPTURE(mapped, device_first, device{}, false) LARGE;
BENCHMARK(host_reads) LARGE;
BENCHMARK(host_whole) LARGE;
BENCHMARK_CAPTURE(on_host, first, false) LARGE;
BENCHMARK_CAPTURE(on_host, next, true) LARGE;
BENCHMARK(mapped_reads) LARGE;
BENCHMARK_CAPTURE(mapped, host_first, host{}, false) LARGE;
BENCHMARK_CAPTURE(mapped, host_next, host{}, true) LARGE;

}  // namespace
}  // namespace chunked_bench

#undef ONCE

BENCHMARK_MAIN();
