// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A CUDA device as a backend: its memory, copies, and kernels in the order of a stream.

#include <clearance/backends/cuda_error.cuh>
#include <clearance/backends/device_buffer.cuh>
#include <clearance/backends/kept_memory.hpp>
#include <clearance/concepts.hpp>
#include <clearance/ground/indices.hpp>
#include <clearance/ground/ptx.hpp>

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace clearance {

// Kernels that start while the one before them in their stream still runs: programmatic dependent launch.

/// Lets the next kernel of the stream start, if it may start early: as soon as all blocks have called this.
__device__ inline void let_next_start() { ptx::launch_dependents(); }

/// Waits until all that is in the stream before this kernel has ended. Its writes are seen then. Code for devices
/// before Hopper does not wait, and such a kernel is not launched early.
__device__ inline void wait_for_stream() { ptx::wait_for_dependencies(); }

/// A kernel that is launched early begins with both. What it could do before it waits is not worth it: the first reads
/// of a frame that comes alone would begin later.
__device__ inline void start_early() {
  let_next_start();
  wait_for_stream();
}

namespace detail {

/// Is the code of a kernel that the current device has loaded new enough to wait for its stream? The driver is asked
/// once for each kernel, because its answer takes longer than a launch.
inline bool waits_for_stream(const void* kernel, int device) {
  static std::mutex one_at_a_time;
  static std::map<std::pair<const void*, int>, bool> known;
  const std::lock_guard lock(one_at_a_time);
  const auto found = known.find({kernel, device});
  if (found != known.end()) return found->second;
  cudaFuncAttributes of{};
  check_cuda(cudaFuncGetAttributes(&of, kernel), "cudaFuncGetAttributes");
  return known[{kernel, device}] = of.ptxVersion >= 90 && of.binaryVersion >= 90;
}

template <class F>
__global__ void __launch_bounds__(128) ranges_kernel(std::size_t n, F body) {
  start_early();
  const std::size_t first = blockIdx.x * std::size_t(blockDim.x) + threadIdx.x;
  if (first < n) body(indices{first, n, std::size_t(gridDim.x) * blockDim.x});
}

template <class F>
struct each_body {
  F body;
  CLEARANCE_HD void operator()(indices range) const {
    for (std::size_t i = range.begin; i < range.end; i += range.step) body(i);
  }
  std::size_t device_stack() const
    requires requires { body.device_stack(); }
  {
    return body.device_stack();
  }
};

/// Bytes that travel as kernel arguments, so that no one waits for a copy from pageable memory.
struct argument_bytes {
  static constexpr std::size_t capacity = 3968;
  alignas(16) std::byte bytes[capacity];
};

template <class T>
__global__ void stage_kernel(std::byte* to, unsigned count, const __grid_constant__ T from) {
  start_early();
  for (unsigned i = threadIdx.x; i < count; i += blockDim.x) to[i] = from.bytes[i];
}

}  // namespace detail

/// Runs on CUDA device `id`, in the order of `stream` (which belongs to that device; null: its default stream). The
/// caller's current device stays as it was.
struct device {
  template <class T>
  using buffer = device_buffer<T>;
  template <class T>
  using scratch = stream_buffer<T>;
  using own_scan = void;  ///< Questions on a device need <clearance/device.cuh>.

  int id = 0;
  cudaStream_t stream = nullptr;

  /// Enqueues your own kernel. A block has `shared` bytes of dynamic shared memory.
  template <class... P, class... A>
  void launch(void (*kernel)(P...), unsigned blocks, unsigned threads, std::size_t shared,
              const A&... arguments) const {
    launch_with({}, kernel, blocks, threads, shared, arguments...);
  }
  /// The same for a kernel that may start while what is in the stream before it still runs, where the device can do
  /// that: all its threads call `wait_for_stream` before they touch what others read or write.
  template <class... P, class... A>
  void launch_early(void (*kernel)(P...), unsigned blocks, unsigned threads, std::size_t shared,
                    const A&... arguments) const {
    const device_guard guard(id);
    if (!detail::waits_for_stream(reinterpret_cast<const void*>(kernel), id))
      return launch(kernel, blocks, threads, shared, arguments...);
    cudaLaunchAttribute early{};
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = 1;
    launch_with(std::span(&early, 1), kernel, blocks, threads, shared, arguments...);
  }

  /// Enqueues `body(indices)` over a grid stride and returns at once. A recursive body gives the stack that it needs,
  /// in bytes, as device_stack(). Throws std::invalid_argument if the device's limit is lower.
  template <class F>
  void for_ranges(std::size_t n, F body) const {
    if (n == 0) return;
    const device_guard guard(id);
    if constexpr (requires { body.device_stack(); }) check_call_stack(body.device_stack());
    constexpr unsigned threads = 128;
    int processors = 0;
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, id), "cudaDeviceGetAttribute");
    const auto blocks = std::min<std::size_t>((n + threads - 1) / threads, std::size_t(processors) * 32);
    launch_early(detail::ranges_kernel<F>, unsigned(blocks), threads, 0, n, body);
  }

  template <class F>
  void for_each(std::size_t n, F body) const {
    for_ranges(n, detail::each_body<F>{body});
  }

  /// Throws std::invalid_argument if a thread may use less call stack than so many bytes.
  void check_call_stack(std::size_t bytes) const {
    const device_guard guard(id);
    std::size_t limit = 0;
    check_cuda(cudaDeviceGetLimit(&limit, cudaLimitStackSize), "cudaDeviceGetLimit");
    if (limit < bytes)
      throw std::invalid_argument("clearance: this recursion may need " + std::to_string(bytes) +
                                  " bytes of call stack a thread, but the device's limit is " + std::to_string(limit) +
                                  "; raise cudaLimitStackSize or use another traversal");
  }

  /// Is this what is thrown where the device's memory ends?
  static bool out_of_memory(const std::exception& error) {
    const auto* its = dynamic_cast<const cuda_error*>(&error);
    return its != nullptr && its->code == cudaErrorMemoryAllocation;
  }

  void wait() const {
    const device_guard guard(id);
    check_cuda(cudaStreamSynchronize(stream), "cudaStreamSynchronize");
  }

  template <class T>
  buffer<T> copy_in(std::span<const T> data) const {
    const device_guard guard(id);
    buffer<T> copy(data.size(), id);
    if (!data.empty())
      check_cuda(cudaMemcpyAsync(copy.data(), data.data(), data.size_bytes(), cudaMemcpyHostToDevice, stream),
                 "cudaMemcpyAsync");
    check_cuda(cudaStreamSynchronize(stream), "cudaStreamSynchronize");
    return copy;
  }

  template <class T>
  std::vector<T> copy_out(const buffer<T>& data) const {
    return copy_out(data.data(), data.size());
  }
  template <class T>
  std::vector<T> copy_out(const T* data, std::size_t n) const {
    const device_guard guard(id);
    std::vector<T> copy(n);
    if (n != 0)
      check_cuda(cudaMemcpyAsync(copy.data(), data, n * sizeof(T), cudaMemcpyDeviceToHost, stream), "cudaMemcpyAsync");
    check_cuda(cudaStreamSynchronize(stream), "cudaStreamSynchronize");
    return copy;
  }

  /// Memory for one call, in stream order.
  template <class T>
  scratch<T> make_scratch(std::size_t n) const {
    return {n, id, stream};
  }

  /// Enqueues a copy of `data`, which may change as soon as this returns. It does not wait.
  template <class T>
  void stage(std::span<const T> data, T* to) const {
    static_assert(std::is_trivially_copyable_v<T>);
    const device_guard guard(id);
    const auto bytes = std::as_bytes(data);
    for (std::size_t at = 0; at < bytes.size(); at += detail::argument_bytes::capacity) {
      detail::argument_bytes chunk;
      const std::size_t n = std::min(bytes.size() - at, detail::argument_bytes::capacity);
      std::copy_n(bytes.data() + at, n, chunk.bytes);
      launch_early(detail::stage_kernel<detail::argument_bytes>, 1, 256, 0, reinterpret_cast<std::byte*>(to) + at,
                   unsigned(n), chunk);
    }
  }

  /// Can kernels read this address as it is (device, pinned or managed memory)?
  bool reads(const void* memory) const {
    const device_guard guard(id);
    cudaPointerAttributes attributes{};
    check_cuda(cudaPointerGetAttributes(&attributes, memory), "cudaPointerGetAttributes");
    if (attributes.type == cudaMemoryTypeUnregistered) return false;
    return attributes.devicePointer != nullptr;
  }

  /// Can they without a bus between? Over a bus, their small reads take more than twice the time of one copy.
  bool holds(const void* memory) const {
    const device_guard guard(id);
    cudaPointerAttributes attributes{};
    check_cuda(cudaPointerGetAttributes(&attributes, memory), "cudaPointerGetAttributes");
    if (attributes.type == cudaMemoryTypeDevice) return attributes.device == id;
    if (attributes.type != cudaMemoryTypeHost) return reads(memory);
    int integrated = 0;
    check_cuda(cudaDeviceGetAttribute(&integrated, cudaDevAttrIntegrated, id), "cudaDeviceGetAttribute");
    return integrated != 0 && attributes.devicePointer != nullptr;
  }

 private:
  template <class... P, class... A>
  void launch_with(std::span<cudaLaunchAttribute> attributes, void (*kernel)(P...), unsigned blocks, unsigned threads,
                   std::size_t shared, const A&... arguments) const {
    const device_guard guard(id);
    cudaLaunchConfig_t how{};
    how.gridDim = blocks;
    how.blockDim = threads;
    how.dynamicSmemBytes = shared;
    how.stream = stream;
    how.attrs = attributes.data();
    how.numAttrs = unsigned(attributes.size());
    check_cuda(cudaLaunchKernelEx(&how, kernel, arguments...), "kernel launch");
  }
};

static_assert(backend<device>);

}  // namespace clearance

namespace clearance::backends {

/// On a device: from `memory`, a resource that hands out device memory, unless that is null.
template <>
class memory_of<device> {
 public:
  using piece = device_buffer<memory_unit>;

  explicit memory_of(const device& on, std::pmr::memory_resource* memory = nullptr) : on_(on), memory_(memory) {}

  piece allocate(std::size_t units) const { return {units, on_.id, memory_}; }

 private:
  device on_;
  std::pmr::memory_resource* memory_;
};

}  // namespace clearance::backends

namespace clearance {

/// Kernels that may use more shared memory than a block always has. A limit is raised once, because that takes longer
/// than a launch. Every translation unit has its own kernels, so they are known by address, not by type, and raised
/// where they are launched.
class raised_limits {
 public:
  /// Raises the limit on the current device, unless that was done.
  void raise(const void* kernel, std::size_t bytes) {
    if (std::ranges::find(kernels_, kernel) != kernels_.end()) return;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(bytes)),
               "cudaFuncSetAttribute");
    kernels_.push_back(kernel);
  }

 private:
  std::vector<const void*> kernels_;
};

}  // namespace clearance
