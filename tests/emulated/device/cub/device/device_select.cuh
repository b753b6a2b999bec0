// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the library uses of this header of CUB, one after another.

#include <cuda_runtime.h>

namespace cub {

struct DeviceSelect {
  template <class In, class Out, class Count, class Wanted>
  static cudaError_t If(void* room, std::size_t& bytes, In from, Out to, Count* count, int n, Wanted wanted,
                        cudaStream_t) {
    if (room == nullptr) {
      bytes = 1;
      return cudaSuccess;
    }
    *count = 0;
    for (int i = 0; i < n; ++i)
      if (const auto value = from[i]; wanted(value)) to[(*count)++] = value;
    return cudaSuccess;
  }
};

}  // namespace cub
