// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions on a device. Each prepared one has a stream of its own, which waits for the caller's by event.

#include "asker.hpp"

#include <clearance/backends/own_stream.cuh>
#include <clearance/device.cuh>
#include <clearance/plan/configurations.hpp>

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

/// The library's query, whose answers stay on the device.
template <class Asker, class Backend, class Model>
class prepared_on_device final : public clearance::any::prepared<Asker, Backend, Model> {
  using in_memory = clearance::any::prepared<Asker, Backend, Model>;
  using Q = typename Asker::question_type;

 public:
  prepared_on_device(const Backend& on, std::shared_ptr<const void> trees, const Model& model, const Q& question)
      : in_memory(on, std::move(trees), model, question), on_(on), parts_(model.view().size()) {}

  std::optional<clearance::distance_certainty> enqueue(std::span<const Eigen::Isometry3d> poses,
                                                       const clouds_about<Q>& clouds, const Q& question,
                                                       const typename out_of<Q>::type& to, void*) override {
    [[maybe_unused]] auto& query = in_memory::query_;
    if constexpr (requires { typename Q::searched; }) {
      check_rigid(poses);
      in_memory::place(poses);
      const auto* const results = query.enqueue(clouds, question);
      const std::size_t count = results_of<Q>(parts_ == 0 ? 0 : poses.size() / parts_, parts_);
      const clearance::device_guard guard(on_.id);
      clearance::check_cuda(cudaMemcpyAsync(to, results, count * sizeof *results, cudaMemcpyDeviceToDevice, on_.stream),
                            "cudaMemcpyAsync");
    } else if constexpr (requires { query.enqueue(poses, clouds, question, to).lower(0); }) {
      return query.enqueue(poses, clouds, question, to);
    } else if constexpr (can_be_enqueued<Q>) {
      query.enqueue(poses, clouds, question, to);
    }
    return {};
  }

 private:
  /// Kernels cannot throw, so the host looks first.
  void check_rigid(std::span<const Eigen::Isometry3d> poses) const {
    for (const Eigen::Isometry3d& pose : poses) {
      clearance::world_transform its(pose);
      if (!clearance::make_rigid(its))
        clearance::plan::named(parts_, poses, [] { throw std::invalid_argument("clearance: a pose is not rigid"); });
    }
  }

  Backend on_;
  std::size_t parts_;
};

template <class Q>
class asker_on_device final : public asker<Q> {
 public:
  asker_on_device(const device_trees& trees, const Q& question, int device)
      : stream_(device),
        event_(device),
        inner_(clearance::any::prepare<asker<Q>, prepared_on_device>(stream_.on(), trees, question)) {}
  asker_on_device(const asker_on_device&) = delete;
  asker_on_device& operator=(const asker_on_device&) = delete;
  /// What was enqueued still uses its memory.
  ~asker_on_device() override {
    clearance::on_device(stream_.on().id, [this] { return cudaStreamSynchronize(stream_.on().stream); });
  }

  typename Q::result operator()(std::span<const Eigen::Isometry3d> poses, const clouds_about<Q>& clouds,
                                const Q& question) override {
    return (*inner_)(poses, clouds, question);
  }
  void forget() override { inner_->forget(); }
  void after(void* caller) override {
    if (is_ordered(caller)) event_.put(static_cast<cudaStream_t>(caller), stream_.on().stream);
  }
  std::optional<clearance::distance_certainty> enqueue(std::span<const Eigen::Isometry3d> poses,
                                                       const clouds_about<Q>& clouds, const Q& question,
                                                       const typename out_of<Q>::type& to, void* caller) override {
    after(caller);
    const auto certain = inner_->enqueue(poses, clouds, question, to, caller);
    if (is_ordered(caller)) event_.put(stream_.on().stream, static_cast<cudaStream_t>(caller));
    return certain;
  }
  void* stream() const override { return stream_.on().stream; }

 private:
  /// 1 and 2 are the legacy and the per-thread default stream, for CUDA too; -1: the caller sees to the order.
  static bool is_ordered(void* caller) { return reinterpret_cast<std::intptr_t>(caller) != -1; }

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
