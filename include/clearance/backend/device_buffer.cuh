// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/kept_pool.cuh>
#include <clearance/backend/owned_buffer.cuh>

namespace clearance {

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
