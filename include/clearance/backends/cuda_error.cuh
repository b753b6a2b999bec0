// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// CUDA calls that fail throw, and work on one device leaves the caller's own device current.

#include <clearance/ground/config.hpp>

#include <cuda_runtime.h>

#include <stdexcept>
#include <string>

namespace clearance {

/// A CUDA runtime call failed; `code` says how.
struct cuda_error : std::runtime_error {
  cudaError_t code;

  cuda_error(cudaError_t code, const char* call)
      : std::runtime_error(std::string("clearance: ") + call + ": " + cudaGetErrorString(code)), code(code) {}
};

inline void check_cuda(cudaError_t code, const char* call) {
  if (code != cudaSuccess) {
    static_cast<void>(cudaGetLastError());  // a sticky error would be blamed on the caller's next call
    throw cuda_error(code, call);
  }
}

/// Makes `device` current while it lives, and the caller's device again afterwards.
class device_guard {
 public:
  explicit device_guard(int device) {
    check_cuda(cudaGetDevice(&before_), "cudaGetDevice");
    if (device != before_) check_cuda(cudaSetDevice(device), "cudaSetDevice");
    changed_ = device != before_;
  }
  ~device_guard() {
    if (changed_) cudaSetDevice(before_);
  }
  device_guard(const device_guard&) = delete;
  device_guard& operator=(const device_guard&) = delete;

 private:
  int before_ = 0;
  bool changed_ = false;
};

}  // namespace clearance
