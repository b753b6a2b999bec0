// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Packs spheres into solids on a GPU, with the same proofs as on the host.

#include <clearance/backends/device.cuh>
#include <clearance/backends/device_buffer.cuh>
#include <clearance/backends/own_stream.cuh>
#include <clearance/packing/growing.hpp>
#include <clearance/packing/pack.hpp>
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
      if (other > best || (other == best && n < number)) {
        best = other;
        number = n;
      }
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
  void eighths(std::size_t n, F f) const {
    each(8 * n, f);
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

/// Packs spheres into a solid on a GPU: a mesh solid, or another with `on(device)`. As on the host, spheres are proven
/// inside and apart in double, the gap is certified, and the same options and seed give the same bits in every run.
/// Throws as `pack` on the host, and cuda_error.
template <solid_for<device> S>
packing pack(const device& on, const S& s, const pack_options& options = {}) {
  const device_guard guard(on.id);
  device_steps steps(on);
  return packer<device, device_steps, S>(on, steps, s, options).run();
}

/// Closes the mesh first; throws std::invalid_argument if it has no inside.
inline packing pack(const device& on, const triangle_mesh& mesh, const pack_options& options = {}) {
  return pack(on, mesh_solid(mesh), options);
}

/// Packs several solids side by side, as on the host, each on its own stream; the stream of `on` is not used.
template <class R>
  requires packable_range<const R>
std::vector<packing> pack(const device& on, const R& solids, const pack_options& options = {}) {
  return pack_each(solids, options, [&](const auto& s, const pack_options& own) {
    const own_stream stream(on.id);
    return pack(stream.on(), s, own);
  });
}

template <solid S>
packing pack(const device&, const S&, const pack_options& = {}) {
  static_assert(sizeof(S) == 0,
                "on a device only solids with on(device) can be packed; pack others on the host: pack(solid, options)");
  return {};
}

}  // namespace clearance
