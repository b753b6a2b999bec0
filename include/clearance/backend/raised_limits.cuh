// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/cuda_error.cuh>

#include <vector>

namespace clearance {

/// Kernels that may use more shared memory than a block always has. A limit is raised once, because that takes longer
/// than a launch. Every translation unit has its own kernels, so they are known by address, not by type, and raised
/// where they are launched.
class raised_limits {
 public:
  /// Raises the limit on the current device, unless that was done. Returns whether the code that this device has loaded
  /// is new enough to wait for its stream.
  bool raise(const void* kernel, std::size_t bytes) {
    for (const raised& its : kernels_)
      if (its.kernel == kernel) return its.waits;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(bytes)),
               "cudaFuncSetAttribute");
    cudaFuncAttributes of{};
    check_cuda(cudaFuncGetAttributes(&of, kernel), "cudaFuncGetAttributes");
    kernels_.push_back({kernel, of.ptxVersion >= 90 && of.binaryVersion >= 90});
    return kernels_.back().waits;
  }

 private:
  struct raised {
    const void* kernel;
    bool waits;
  };
  std::vector<raised> kernels_;
};

}  // namespace clearance
