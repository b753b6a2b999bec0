// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device.cuh>
#include <clearance/backend/pinned_buffer.cuh>
#include <clearance/packing/growing.hpp>
#include <clearance/packing/round_bodies.hpp>

#include <thrust/iterator/counting_iterator.h>
#include <cub/device/device_reduce.cuh>
#include <cub/device/device_select.cuh>

namespace clearance {

/// Half a warp that shares one climb.
struct half_warp {
  __device__ int rank() const { return int(threadIdx.x) % 16; }
  __device__ int lanes() const { return 16; }
  __device__ void meet() const { __syncwarp(group()); }
  /// The largest value, and of equal ones the lowest number; all call it.
  __device__ void agree(double& best, int& number) const {
    for (int apart = 8; apart > 0; apart /= 2) {
      const double other = __shfl_xor_sync(group(), best, apart, 16);
      const int n = __shfl_xor_sync(group(), number, apart, 16);
      if (other > best || (other == best && n < number)) best = other, number = n;
    }
  }

 private:
  __device__ static unsigned group() { return 0xffffu << (threadIdx.x % 32 & ~15u); }
};

namespace detail {

template <class F>
__global__ void __launch_bounds__(128) climbers_kernel(std::size_t n, F f) {
  const std::size_t i = (blockIdx.x * std::size_t(blockDim.x) + threadIdx.x) / 16;
  if (i < n) f(i, half_warp{});
}

struct larger {
  CLEARANCE_HD double operator()(double a, double b) const { return a < b ? b : a; }
};

}  // namespace detail

/// What packing in rounds needs besides a backend, by CUB. The host waits for counts, which decide what comes next.
class device_steps {
 public:
  static constexpr std::size_t cells = 1u << 22;

  explicit device_steps(const device& on) : on_(on), temporary_(on), count_(1, on.id), most_(1, on.id) {}

  /// Takes all keys from 0.9 of the largest at once: enough for thousands of threads.
  std::size_t next(const double* keys, std::size_t n, std::size_t most, std::uint32_t* out, double& least) {
    least = 0.9 * largest(n, rounds::key_of{keys});
    return least > 0 ? std::min(most, select(n, rounds::at_least{keys, least}, out)) : 0;
  }
  void forget() {}

  template <class F>
  void each(std::size_t n, F f) const {
    on_.for_each(n, f);
  }
  template <class F>
  std::size_t select(std::size_t n, F f, std::uint32_t* out) {
    if (n == 0) return 0;
    run([&](void* memory, std::size_t& bytes) {
      return cub::DeviceSelect::If(memory, bytes, numbers(), out, count_.data(), int(n), f, on_.stream);
    });
    return *count_.data();
  }
  template <class F>
  double largest(std::size_t n, F f) {
    if (n == 0) return 0;
    run([&](void* memory, std::size_t& bytes) {
      return cub::DeviceReduce::TransformReduce(memory, bytes, numbers(), most_.data(), int(n), detail::larger{}, f,
                                                0.0, on_.stream);
    });
    return *most_.data();
  }
  template <class F>
  void climbers(std::size_t n, F f) const {
    on_.launch(detail::climbers_kernel<F>, unsigned((n + 7) / 8), 128, 0, n, f);
  }

 private:
  static thrust::counting_iterator<std::uint32_t> numbers() { return thrust::counting_iterator<std::uint32_t>(0); }

  template <class F>
  void run(F f) {
    const device_guard guard(on_.id);
    std::size_t bytes = 0;
    check_cuda(f(nullptr, bytes), "CUB");
    check_cuda(f(temporary_.reserve(bytes), bytes), "CUB");
    on_.wait();
  }

  device on_;
  growing<unsigned char, device> temporary_;
  pinned_buffer<std::uint32_t> count_;
  pinned_buffer<double> most_;
};

}  // namespace clearance
