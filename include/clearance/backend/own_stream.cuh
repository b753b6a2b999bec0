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

/// An event without a time. Until it is given one, it has none.
class own_event {
 public:
  own_event() = default;
  explicit own_event(int id) : id_(id) {
    const device_guard guard(id);
    check_cuda(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "cudaEventCreateWithFlags");
  }
  own_event(own_event&& other) noexcept { *this = std::move(other); }
  own_event& operator=(own_event&& other) noexcept {
    return std::swap(event_, other.event_), std::swap(id_, other.id_), *this;
  }
  ~own_event() {
    if (event_ != nullptr) on_device(id_, [this] { return cudaEventDestroy(event_); });
  }

  cudaEvent_t get() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
  int id_ = 0;
};

}  // namespace clearance
