// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the library uses of this header of CUB, one after another.

#include <cuda_runtime.h>

namespace cub {

struct DeviceReduce {
  template <class In, class Out, class Join, class Make, class T>
  static cudaError_t TransformReduce(void* room, std::size_t& bytes, In from, Out to, int n, Join join, Make make,
                                     T start, cudaStream_t) {
    if (room == nullptr) {
      bytes = 1;
      return cudaSuccess;
    }
    for (int i = 0; i < n; ++i) start = join(start, make(from[i]));
    *to = start;
    return cudaSuccess;
  }
};

}  // namespace cub
