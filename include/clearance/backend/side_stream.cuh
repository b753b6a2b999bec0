// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/own_stream.cuh>

namespace clearance {

/// Work that may run beside other work of a stream. Later work of the stream waits for it. A captured graph includes
/// both.
class side_stream {
 public:
  explicit side_stream(const device& main) : main_(main), side_(main.id) {
    const device_guard guard(main.id);
    for (cudaEvent_t& event : events_)
      check_cuda(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), "cudaEventCreateWithFlags");
  }
  side_stream(const side_stream&) = delete;
  side_stream& operator=(const side_stream&) = delete;
  ~side_stream() {
    for (const cudaEvent_t event : events_)
      if (event != nullptr) on_device(main_.id, [event] { return cudaEventDestroy(event); });
  }

  /// From here on, side work may run beside what the main stream gets.
  void fork() const {
    const device_guard guard(main_.id);
    check_cuda(cudaEventRecord(events_[0], main_.stream), "cudaEventRecord");
  }
  /// Enqueues the side work by `enqueue(device)`. What the main stream gets after this waits for it.
  template <class F>
  void join(const F& enqueue) const {
    const device_guard guard(main_.id);
    const device side = side_.on();
    check_cuda(cudaStreamWaitEvent(side.stream, events_[0]), "cudaStreamWaitEvent");
    enqueue(side);
    check_cuda(cudaEventRecord(events_[1], side.stream), "cudaEventRecord");
    check_cuda(cudaStreamWaitEvent(main_.stream, events_[1]), "cudaStreamWaitEvent");
  }

 private:
  device main_;
  own_stream side_;
  cudaEvent_t events_[2] = {nullptr, nullptr};
};

}  // namespace clearance
