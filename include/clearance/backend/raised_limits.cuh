// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/cuda_error.cuh>

#include <algorithm>
#include <vector>

namespace clearance {

/// Kernels that may use more shared memory than a block always has. A limit is raised once, because that takes longer
/// than a launch. Every translation unit has its own kernels, so they are known by address, not by type, and raised
/// where they are launched.
class raised_limits {
 public:
  /// Raises the limit on the current device, unless that was done.
  void raise(const void* kernel, std::size_t bytes) {
    if (std::find(kernels_.begin(), kernels_.end(), kernel) != kernels_.end()) return;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(bytes)),
               "cudaFuncSetAttribute");
    kernels_.push_back(kernel);
  }

 private:
  std::vector<const void*> kernels_;
};

}  // namespace clearance
