// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device.cuh>

namespace clearance {

/// What a device has for the blocks of a kernel.
struct processors_of {
  unsigned count = 0;
  std::size_t shared = 0, of_block = 0;  ///< Bytes of shared memory: of a processor, and the most of a block.

  explicit processors_of(const device& on)
      : count(ask(on, cudaDevAttrMultiProcessorCount)),
        shared(ask(on, cudaDevAttrMaxSharedMemoryPerMultiprocessor)),
        of_block(ask(on, cudaDevAttrMaxSharedMemoryPerBlockOptin)) {}

 private:
  static unsigned ask(const device& on, cudaDeviceAttr what) {
    int value = 0;
    check_cuda(cudaDeviceGetAttribute(&value, what, on.id), "cudaDeviceGetAttribute");
    return unsigned(value);
  }
};

}  // namespace clearance
