// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How work on a device overlaps: streams beside the caller's.

#include <clearance/backends/beside.hpp>
#include <clearance/backends/device.cuh>

#include <memory>

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
    std::swap(event_, other.event_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~own_event() {
    if (event_ != nullptr) on_device(id_, [this] { return cudaEventDestroy(event_); });
  }

  cudaEvent_t get() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
  int id_ = 0;
};

/// Work that may run beside other work of a stream. Later work of the stream waits for it. A captured graph includes
/// both.
class side_stream {
 public:
  explicit side_stream(const device& main) : main_(main), side_(main.id), forked_(main.id), joined_(main.id) {}

  /// From here on, side work may run beside what the main stream gets.
  void fork() const {
    const device_guard guard(main_.id);
    check_cuda(cudaEventRecord(forked_.get(), main_.stream), "cudaEventRecord");
  }
  /// Enqueues the side work by `enqueue(device)`. What the main stream gets after this waits for it.
  template <class F>
  void join(const F& enqueue) const {
    const device_guard guard(main_.id);
    const device side = side_.on();
    check_cuda(cudaStreamWaitEvent(side.stream, forked_.get()), "cudaStreamWaitEvent");
    enqueue(side);
    check_cuda(cudaEventRecord(joined_.get(), side.stream), "cudaEventRecord");
    check_cuda(cudaStreamWaitEvent(main_.stream, joined_.get()), "cudaStreamWaitEvent");
  }

 private:
  device main_;
  own_stream side_;
  own_event forked_, joined_;
};

}  // namespace clearance

namespace clearance::backends {

/// A stream of its own. With somebody else's memory it is the same stream, because that may come in stream order.
template <>
class beside<device> {
 public:
  explicit beside(const device& main) : main_(main), stream_(std::make_unique<own_stream>(main.id)), before_(main.id) {}
  template <class... Memory>
  beside(const device& main, Memory...) : main_(main) {}

  device on() const { return stream_ == nullptr ? main_ : stream_->on(); }
  void follow() const {
    if (stream_ == nullptr) return;
    const device_guard guard(main_.id);
    check_cuda(cudaEventRecord(before_.get(), main_.stream), "cudaEventRecord");
    check_cuda(cudaStreamWaitEvent(on().stream, before_.get()), "cudaStreamWaitEvent");
  }
  void wait() const { on().wait(); }

 private:
  device main_;
  std::unique_ptr<own_stream> stream_;
  own_event before_;
};

}  // namespace clearance::backends
