// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/owned_buffer.cuh>

namespace clearance {

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

}  // namespace clearance
