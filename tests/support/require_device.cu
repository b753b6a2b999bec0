// SPDX-License-Identifier: BSD-3-Clause
// Linked into every program that needs a GPU. On a machine without a usable one it exits before main with 77, which
// CTest reports as "skipped", so a device test never passes by not running. With CLEARANCE_REQUIRE_DEVICE set in the
// environment that is a failure instead.

#include <cuda_runtime.h>

#include <cstdio>
#include <cstdlib>

namespace {
const bool device_found = [] {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaSuccess && count > 0) return true;
  std::printf("SKIPPED: needs a CUDA device (%s)\n",
              status == cudaSuccess ? "none present" : cudaGetErrorString(status));
  std::fflush(stdout);
  std::_Exit(std::getenv("CLEARANCE_REQUIRE_DEVICE") != nullptr ? 1 : 77);
}();
}  // namespace
