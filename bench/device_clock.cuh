// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How benchmarks time a device, and the floor for comparison.

#include <clearance/backends/cuda_error.cuh>

#include <cstddef>

namespace bench {

using clearance::check_cuda;

/// Keeps the device busy for 200 us: longer than the host takes to enqueue a frame and two events.
template <bool Dummy = true>
__global__ void spin_kernel() {
  const auto now = [] {
    unsigned long long ns;
    asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(ns));
    return ns;
  };
  const unsigned long long start = now();
  while (now() - start < 200000) {
  }
}

template <bool Dummy = true>
__global__ void empty_kernel() {}

/// CUDA events around work on the default stream. On an idle device the time includes the host's, from the first event
/// to the launch. Queued behind other work, it is the device's alone, including the start and end of each kernel.
class device_clock {
 public:
  explicit device_clock(bool queued = false) : queued_(queued) {
    check_cuda(cudaEventCreate(&start_), "cudaEventCreate"), check_cuda(cudaEventCreate(&stop_), "cudaEventCreate");
  }
  device_clock(const device_clock&) = delete;
  device_clock& operator=(const device_clock&) = delete;
  ~device_clock() { cudaEventDestroy(start_), cudaEventDestroy(stop_); }

  template <class F>
  double microseconds(F enqueue) const {
    check_cuda(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
    if (queued_) spin_kernel<><<<1, 1>>>();
    check_cuda(cudaEventRecord(start_), "cudaEventRecord");
    enqueue();
    check_cuda(cudaEventRecord(stop_), "cudaEventRecord");
    check_cuda(cudaEventSynchronize(stop_), "cudaEventSynchronize");
    float ms = 0;
    check_cuda(cudaEventElapsedTime(&ms, start_, stop_), "cudaEventElapsedTime");
    return ms * 1e3;
  }
  template <class F>
  double seconds(F enqueue) const {
    return microseconds(enqueue) * 1e-6;
  }

 private:
  bool queued_;
  cudaEvent_t start_ = nullptr, stop_ = nullptr;
};

/// The floor: reads each byte once, and finds nothing.
template <bool Dummy = true>
__global__ void read_kernel(const float4* from, std::size_t count, float* never) {
  float least = 0;
  for (std::size_t i = blockIdx.x * std::size_t(blockDim.x) + threadIdx.x; i < count;
       i += std::size_t(gridDim.x) * blockDim.x) {
    const float4 f = from[i];
    least = fminf(least, fminf(fminf(f.x, f.y), fminf(f.z, f.w)));
  }
  if (least == -1.2345e30f) *never = least;
}

}  // namespace bench
