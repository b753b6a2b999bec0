// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device_buffer.cuh>

namespace clearance {

/// Page-locked host memory that kernels can write and the host can watch: its own, or from a caller's resource, which
/// hands out such memory and outlives it.
template <class T>
class pinned_buffer {
 public:
  pinned_buffer() = default;
  pinned_buffer(std::size_t n, int device, std::pmr::memory_resource* from = nullptr)
      : size_(n), device_(device), from_(from) {
    const device_guard guard(device);
    if (n == 0) return;
    if (from != nullptr)
      data_ = static_cast<T*>(from->allocate(n * sizeof(T), alignment));
    else
      check_cuda(
          cudaHostAlloc(reinterpret_cast<void**>(&data_), n * sizeof(T), cudaHostAllocPortable | cudaHostAllocMapped),
          "cudaHostAlloc");
  }
  pinned_buffer(pinned_buffer&& other) noexcept { *this = std::move(other); }
  pinned_buffer& operator=(pinned_buffer&& other) noexcept {
    std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(device_, other.device_),
        std::swap(from_, other.from_);
    return *this;
  }
  ~pinned_buffer() {
    if (data_ != nullptr)
      on_device(device_, [this] {
        if (from_ != nullptr)
          from_->deallocate(data_, size_ * sizeof(T), alignment);
        else
          cudaFreeHost(data_);
      });
  }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t alignment = 64;

  T* data_ = nullptr;
  std::size_t size_ = 0;
  int device_ = 0;
  std::pmr::memory_resource* from_ = nullptr;
};

}  // namespace clearance
