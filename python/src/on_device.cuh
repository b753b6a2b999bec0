// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions on a device. Each prepared one has a stream of its own, which waits for the caller's by event.

#include "prepared.hpp"

#include <clearance/backend/own_stream.cuh>
#include <clearance/device.cuh>

#include <map>
#include <string>
#include <typeinfo>

using device_trees = std::shared_ptr<const robot_trees<clearance::device>>;

/// What makes an asker, by the name of the question's C++ type.
using maker = void* (*)(const device_trees& trees, const void* question, int device);
inline std::map<std::string, maker>& all_makers() {
  static std::map<std::string, maker> all;
  return all;
}

/// Lets work in one stream wait for what is in another now.
class waiting {
 public:
  explicit waiting(int device) : device_(device) {
    const clearance::device_guard guard(device);
    clearance::check_cuda(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "cudaEventCreateWithFlags");
  }
  waiting(const waiting&) = delete;
  waiting& operator=(const waiting&) = delete;
  ~waiting() {
    clearance::on_device(device_, [this] { return cudaEventDestroy(event_); });
  }
  void put(cudaStream_t first, cudaStream_t then) const {
    const clearance::device_guard guard(device_);
    clearance::check_cuda(cudaEventRecord(event_, first), "cudaEventRecord");
    clearance::check_cuda(cudaStreamWaitEvent(then, event_), "cudaStreamWaitEvent");
  }

 private:
  int device_;
  cudaEvent_t event_ = nullptr;
};

template <class Q>
class asker_on_device final : public asker<Q> {
 public:
  asker_on_device(const device_trees& trees, const Q& question, int device)
      : stream_(device), event_(device), inner_(prepare(stream_.on(), trees, question)) {}

  typename Q::result ask(std::span<const Eigen::Isometry3d> poses, const std::vector<any_cloud>& clouds,
                         const Q& question) override {
    return inner_->ask(poses, clouds, question);
  }
  /// 1 and 2 are the legacy and the per-thread default stream, for CUDA too; -1: the caller has seen to it.
  void after(void* stream) override {
    if (reinterpret_cast<std::intptr_t>(stream) != -1)
      event_.put(static_cast<cudaStream_t>(stream), stream_.on().stream);
  }

 private:
  clearance::own_stream stream_;
  waiting event_;
  std::unique_ptr<asker<Q>> inner_;
};

/// Adds a question to those that the module answers.
template <class Q>
struct answered_on_device {
  answered_on_device() {
    all_makers()[typeid(Q).name()] = [](const device_trees& trees, const void* question, int device) -> void* {
      asker<Q>* const made = new asker_on_device<Q>(trees, *static_cast<const Q*>(question), device);
      return made;
    };
  }
};
