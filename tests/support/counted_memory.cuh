// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backends/cuda_error.cuh>

#include <algorithm>
#include <memory_resource>

namespace testing {

/// Device memory that is counted: how often it was asked for, bytes that are held, and the most that were.
class counted_memory : public std::pmr::memory_resource {
 public:
  std::size_t asked = 0, held = 0, most = 0;

 private:
  void* do_allocate(std::size_t bytes, std::size_t) override {
    void* p = nullptr;
    clearance::check_cuda(cudaMalloc(&p, bytes), "cudaMalloc");
    ++asked, held += bytes, most = std::max(most, held);
    return p;
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t) override { cudaFree(p), held -= bytes; }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }
};

}  // namespace testing
