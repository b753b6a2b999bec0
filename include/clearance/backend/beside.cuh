// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/beside.hpp>
#include <clearance/backend/own_stream.cuh>

#include <memory>

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
