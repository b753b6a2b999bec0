// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/cuda_error.cuh>

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
    std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(device_, other.device_),
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
}  // namespace clearance
