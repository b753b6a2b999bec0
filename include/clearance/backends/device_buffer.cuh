// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Arrays in device memory and in pinned memory, and pools that spare the driver's slow allocations.

#include <clearance/backends/cuda_error.cuh>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory_resource>
#include <mutex>
#include <utility>
#include <vector>

namespace clearance {

/// Calls `action` with `device` current. For destructors, which cannot throw.
template <class F>
void on_device(int device, F action) {
  int before = device;
  cudaGetDevice(&before);
  if (before != device) cudaSetDevice(device);
  action();
  if (before != device) cudaSetDevice(before);
}

namespace backends {

/// Owns an array in memory of a kind: its own, or from a caller's resource, which hands out such memory and outlives
/// it. `Kind` says how memory is allocated and freed, what that call is named, and to what it is aligned.
template <class T, class Kind>
class owned_buffer {
 public:
  using value_type = T;

  owned_buffer() = default;
  owned_buffer(std::size_t n, int device, std::pmr::memory_resource* from = nullptr)
      : size_(n), device_(device), from_(from) {
    const device_guard guard(device);
    if (n == 0) return;
    if (from != nullptr)
      data_ = static_cast<T*>(from->allocate(n * sizeof(T), Kind::alignment));
    else
      check_cuda(Kind::allocate(reinterpret_cast<void**>(&data_), n * sizeof(T)), Kind::call);
  }
  owned_buffer(owned_buffer&& other) noexcept { *this = std::move(other); }
  owned_buffer& operator=(owned_buffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(device_, other.device_);
    std::swap(from_, other.from_);
    return *this;
  }
  ~owned_buffer() {
    if (data_ != nullptr)
      on_device(device_, [this] {
        if (from_ != nullptr)
          from_->deallocate(data_, size_ * sizeof(T), Kind::alignment);
        else
          Kind::free(data_);
      });
  }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  int device_ = 0;
  std::pmr::memory_resource* from_ = nullptr;
};

}  // namespace backends

/// The library's own pool of device memory, one per device, for memory in stream order. It keeps some memory: the
/// driver's default pool releases everything whenever someone waits, and takes tens of microseconds to get it again. It
/// is never destroyed.
inline cudaMemPool_t kept_pool(int device) {
  static std::mutex one_at_a_time;
  static std::map<int, cudaMemPool_t> pools;
  const std::lock_guard lock(one_at_a_time);
  cudaMemPool_t& pool = pools[device];
  if (pool == nullptr) {
    cudaMemPoolProps properties{};
    properties.allocType = cudaMemAllocationTypePinned;
    properties.location.type = cudaMemLocationTypeDevice;
    properties.location.id = device;
    check_cuda(cudaMemPoolCreate(&pool, &properties), "cudaMemPoolCreate");
    std::uint64_t kept = 64 << 20;  // bytes; pools grow by 32 MiB, and one that has more than this releases everything
    check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &kept), "cudaMemPoolSetAttribute");
  }
  return pool;
}

namespace backends {

struct pinned_memory {
  static constexpr const char* call = "cudaHostAlloc";
  static constexpr std::size_t alignment = 64;
  static cudaError_t allocate(void** data, std::size_t bytes) {
    return cudaHostAlloc(data, bytes, cudaHostAllocPortable | cudaHostAllocMapped);
  }
  static void free(void* data) { cudaFreeHost(data); }
};

}  // namespace backends

/// Page-locked host memory that kernels can write and the host can watch.
template <class T>
class pinned_buffer : public backends::owned_buffer<T, backends::pinned_memory> {
 public:
  using backends::owned_buffer<T, backends::pinned_memory>::owned_buffer;
};

namespace backends {

/// Keeps pieces of pinned memory that are given back, by their sizes, which are powers of two.
class kept_pieces : public std::pmr::memory_resource {
  static constexpr std::size_t least = 4 << 10, most_kept = 64 << 20;

  static std::size_t size_for(std::size_t bytes) { return bytes <= least ? least : std::bit_ceil(bytes); }

  void* do_allocate(std::size_t bytes, std::size_t) override {
    const std::size_t size = size_for(bytes);
    {
      const std::lock_guard lock(one_at_a_time_);
      if (auto& kept = kept_[size]; !kept.empty()) {
        void* const memory = kept.back();
        kept.pop_back();
        return memory;
      }
    }
    void* memory = nullptr;
    check_cuda(pinned_memory::allocate(&memory, size), pinned_memory::call);
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t) override {
    const std::size_t size = size_for(bytes);
    if (size > most_kept) return pinned_memory::free(memory);
    const std::lock_guard lock(one_at_a_time_);
    kept_[size].push_back(memory);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  std::mutex one_at_a_time_;
  std::map<std::size_t, std::vector<void*>> kept_;
};

}  // namespace backends

/// Pinned memory for any device. It keeps pieces that are given back, because the driver takes 0.2 ms for each, and
/// more for large ones. Give a piece back only when no device will write to it any more. It lives as long as the
/// process.
inline std::pmr::memory_resource* kept_pinned() {
  static std::pmr::memory_resource* const kept = new backends::kept_pieces;
  return kept;
}

namespace backends {

struct device_memory {
  static constexpr const char* call = "cudaMalloc";
  static constexpr std::size_t alignment = 256;  // as cudaMalloc promises
  static cudaError_t allocate(void** data, std::size_t bytes) { return cudaMalloc(data, bytes); }
  static void free(void* data) { cudaFree(data); }
};

}  // namespace backends

/// Device memory. Freeing its own waits until no stream can still be reading it; a resource has to ensure that itself.
template <class T>
class device_buffer : public backends::owned_buffer<T, backends::device_memory> {
 public:
  using backends::owned_buffer<T, backends::device_memory>::owned_buffer;
};

/// Device memory for one call, allocated and freed in stream order, so that the host never waits for it.
template <class T>
class stream_buffer {
 public:
  using value_type = T;

  stream_buffer(std::size_t n, int device, cudaStream_t stream) : size_(n), device_(device), stream_(stream) {
    const device_guard guard(device);
    if (n == 0) return;
    check_cuda(cudaMallocFromPoolAsync(reinterpret_cast<void**>(&data_), n * sizeof(T), kept_pool(device), stream),
               "cudaMallocFromPoolAsync");
  }
  stream_buffer(stream_buffer&& other) noexcept { *this = std::move(other); }
  stream_buffer& operator=(stream_buffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(device_, other.device_);
    std::swap(stream_, other.stream_);
    return *this;
  }
  ~stream_buffer() {
    if (data_ != nullptr) on_device(device_, [this] { return cudaFreeAsync(data_, stream_); });
  }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  int device_ = 0;
  cudaStream_t stream_ = nullptr;
};

}  // namespace clearance
