// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/cuda_error.cuh>
#include <clearance/backend/kept_pool.cuh>

#include <cstddef>
#include <memory_resource>
#include <utility>

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

/// Owns an array in device memory, its own or from a caller's resource (which hands out device memory and outlives it).
/// Freeing its own waits until no stream can still be reading it; a resource has to ensure that itself.
template <class T>
class device_buffer {
 public:
  using value_type = T;

  device_buffer() = default;
  device_buffer(std::size_t n, int device, std::pmr::memory_resource* from = nullptr)
      : size_(n), device_(device), from_(from) {
    const device_guard guard(device);
    if (n == 0) return;
    if (from != nullptr)
      data_ = static_cast<T*>(from->allocate(n * sizeof(T), alignment));
    else
      check_cuda(cudaMalloc(reinterpret_cast<void**>(&data_), n * sizeof(T)), "cudaMalloc");
  }
  device_buffer(device_buffer&& other) noexcept { *this = std::move(other); }
  device_buffer& operator=(device_buffer&& other) noexcept {
    std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(device_, other.device_),
        std::swap(from_, other.from_);
    return *this;
  }
  ~device_buffer() {
    if (data_ != nullptr)
      on_device(device_, [this] {
        if (from_ != nullptr)
          from_->deallocate(data_, size_ * sizeof(T), alignment);
        else
          cudaFree(data_);
      });
  }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t alignment = 256;  // as cudaMalloc promises

  T* data_ = nullptr;
  std::size_t size_ = 0;
  int device_ = 0;
  std::pmr::memory_resource* from_ = nullptr;
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
    std::swap(data_, other.data_), std::swap(size_, other.size_);
    std::swap(device_, other.device_), std::swap(stream_, other.stream_);
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
