// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/cuda_error.cuh>

#include <cstddef>
#include <memory_resource>

namespace clearance {

/// Pinned memory for any device. It keeps pieces that are given back, because the driver takes 0.2 ms for each. Give a
/// piece back only when no device will write to it any more. It lives as long as the process.
inline std::pmr::memory_resource* kept_pinned() {
  class from_driver : public std::pmr::memory_resource {
    void* do_allocate(std::size_t bytes, std::size_t) override {
      void* memory = nullptr;
      check_cuda(cudaHostAlloc(&memory, bytes, cudaHostAllocPortable | cudaHostAllocMapped), "cudaHostAlloc");
      return memory;
    }
    void do_deallocate(void* memory, std::size_t, std::size_t) override { cudaFreeHost(memory); }
    bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }
  };
  static std::pmr::memory_resource* const kept =
      new std::pmr::synchronized_pool_resource({64, 64 << 10}, new from_driver);
  return kept;
}

}  // namespace clearance
