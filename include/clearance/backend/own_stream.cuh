// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/device.cuh>

namespace clearance {

/// A stream for work beside other work of the same device. Do not destroy it before all its work is done.
class own_stream {
 public:
  explicit own_stream(int id, unsigned flags = cudaStreamNonBlocking) : id_(id) {
    const device_guard guard(id);
    check_cuda(cudaStreamCreateWithFlags(&stream_, flags), "cudaStreamCreateWithFlags");
  }
  own_stream(const own_stream&) = delete;
  own_stream& operator=(const own_stream&) = delete;
  ~own_stream() {
    on_device(id_, [this] { return cudaStreamDestroy(stream_); });
  }

  device on() const { return {id_, stream_}; }

 private:
  int id_;
  cudaStream_t stream_ = nullptr;
};

}  // namespace clearance
