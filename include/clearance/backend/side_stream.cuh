// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/own_stream.cuh>

namespace clearance {

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
