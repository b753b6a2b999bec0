// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Shared by the benchmarks of the minimum on a device.
#include "device_clock.cuh"
#include "scene.hpp"

#include <clearance/device.cuh>
#include <clearance/questions/min_distance.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>

namespace bench {

/// The frame, repeated with 2 mm of noise up to `count` points. Made once per frame and count, because that takes
/// longer than the measurement.
inline const std::vector<clearance::vec3>& repeated(const std::vector<clearance::vec3>& frame, std::size_t count) {
  static std::map<std::pair<const clearance::vec3*, std::size_t>, std::vector<clearance::vec3>> made;
  std::vector<clearance::vec3>& points = made[{frame.data(), count}];
  if (!points.empty()) return points;
  std::mt19937 bits(7);
  std::normal_distribution<float> noise(0, 0.002f);
  points.assign(frame.begin(), frame.begin() + std::ptrdiff_t(std::min(count, frame.size())));
  while (points.size() < count) {
    const auto p = frame[points.size() % frame.size()];
    points.push_back({p.x + noise(bits), p.y + noise(bits), p.z + noise(bits)});
  }
  return points;
}

/// Times `calls` calls by the host's clock, after `others` that do not count. Calls `before` before each, untimed.
template <class F, class Before>
void percentiles(benchmark::State& state, std::size_t calls, std::size_t others, F call, Before before) {
  std::vector<double> us;
  for (auto _ : state) {
    for (std::size_t k = 0; k < calls + others; ++k) {
      before();
      const auto start = std::chrono::steady_clock::now();
      call(k);
      if (k >= others)
        us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    }
  }
  std::sort(us.begin(), us.end());
  state.SetIterationTime(us[us.size() / 2] * 1e-6);
  state.counters["p99_9_us"] = us[us.size() * 999 / 1000];
  state.counters["max_us"] = us.back();
}
template <class F>
void percentiles(benchmark::State& state, std::size_t calls, F call) {
  percentiles(state, calls, 100, call, [] {});
}

template <class T>
clearance::pinned_buffer<T> pinned(const std::vector<T>& data, const clearance::device& gpu) {
  clearance::pinned_buffer<T> copy(data.size(), gpu.id);
  std::copy(data.begin(), data.end(), copy.data());
  return copy;
}

inline bool no_device(benchmark::State& state) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) == cudaSuccess && devices > 0) return false;
  static_cast<void>(cudaGetLastError());
  state.SkipWithError("no CUDA device");
  return true;
}

}  // namespace bench
