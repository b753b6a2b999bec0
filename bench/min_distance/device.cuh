// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the benchmarks of the minimum on a device share.
#include "scene.hpp"

#include <clearance/min_distance_query.cuh>

#include <benchmark/benchmark.h>

namespace bench {

using clearance::check_cuda;

class events {
 public:
  events() { check_cuda(cudaEventCreate(&start_), "cudaEventCreate"), check_cuda(cudaEventCreate(&stop_), "cudaEventCreate"); }
  ~events() { cudaEventDestroy(start_), cudaEventDestroy(stop_); }

  template <class F>
  double seconds(F enqueue) {
    check_cuda(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
    check_cuda(cudaEventRecord(start_), "cudaEventRecord");
    enqueue();
    check_cuda(cudaEventRecord(stop_), "cudaEventRecord");
    check_cuda(cudaEventSynchronize(stop_), "cudaEventSynchronize");
    float ms = 0;
    check_cuda(cudaEventElapsedTime(&ms, start_, stop_), "cudaEventElapsedTime");
    return ms / 1e3;
  }

 private:
  cudaEvent_t start_ = nullptr, stop_ = nullptr;
};

/// The frame, repeated with 2 mm of noise until there are `count` points.
inline std::vector<clearance::vec3> repeated(const std::vector<clearance::vec3>& frame, std::size_t count) {
  std::mt19937 bits(7);
  std::normal_distribution<float> noise(0, 0.002f);
  std::vector<clearance::vec3> points(frame.begin(), frame.begin() + std::ptrdiff_t(std::min(count, frame.size())));
  while (points.size() < count) {
    const auto p = frame[points.size() % frame.size()];
    points.push_back({p.x + noise(bits), p.y + noise(bits), p.z + noise(bits)});
  }
  return points;
}

template <bool Dummy = true>
__global__ void read_only(const float4* from, std::size_t count, float* never) {
  float least = 0;
  for (std::size_t i = blockIdx.x * std::size_t(blockDim.x) + threadIdx.x; i < count; i += std::size_t(gridDim.x) * blockDim.x) {
    const float4 f = from[i];
    least = fminf(least, fminf(fminf(f.x, f.y), fminf(f.z, f.w)));
  }
  if (least == -1.2345e30f) *never = least;
}

inline bool no_device(benchmark::State& state) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) == cudaSuccess && devices > 0) return false;
  static_cast<void>(cudaGetLastError());
  state.SkipWithError("no CUDA device");
  return true;
}

}  // namespace bench
