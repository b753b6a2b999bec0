// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks about many configurations on a device, frame after frame. Their poses may stay there.

#include <clearance/backends/device.cuh>
#include <clearance/backends/one_call.cuh>
#include <clearance/frames/readable.cuh>
#include <clearance/plan/configurations.hpp>
#include <clearance/plan/device_batch.cuh>
#include <clearance/plan/engine.hpp>

namespace clearance::plan {

/// A question about many configurations on a device, and their poses. The prepared questions inherit from it.
template <class PartView, class Question>
class placed_batch {
 public:
  /// Keeps poses, also on the device, for later frames: a watched trajectory is copied once. Enqueued. Throws
  /// std::invalid_argument if the last configuration is not whole.
  void place(std::span<const Eigen::Isometry3d> poses) {
    asked_ = detail::count_configurations(search_.parts(), poses.size());
    search_.place(poses);
    poses_.assign(poses.begin(), poses.end());
  }
  /// Keeps the poses of joint vectors, one after another, which the device computes. Throws std::invalid_argument as
  /// joint_chain::count, and if the chain belongs to another robot. Not for a graph: it copies from host memory.
  void place(const joint_chain<device>& chain, std::span<const double> q) {
    const std::size_t count = chain.count(q);
    if (there_.size() < q.size()) there_ = device_buffer<double>(q.size(), on_.id, memory_);
    q_.assign(q.begin(), q.end());
    if (!q.empty()) {
      const device_guard guard(on_.id);
      check_cuda(cudaMemcpyAsync(there_.data(), q_.data(), q.size_bytes(), cudaMemcpyHostToDevice, on_.stream),
                 "cudaMemcpyAsync");
    }
    place(chain, there_.data(), count);
  }
  /// The same for joint vectors in device memory. A vector that is not finite or beyond its limits makes poses that are
  /// not rigid.
  void place(const joint_chain<device>& chain, const double* q, std::size_t configurations) {
    detail::check_chain(search_.parts(), chain.parts());
    poses_.clear();
    asked_ = configurations;
    search_.place(std::uint32_t(configurations), [&](world_transform* there) {
      on_.for_each(configurations * chain.parts(), place_links{chain.view(), q, there});
    });
  }

 protected:
  placed_batch(const device& on, const model_view<PartView>& model, bool each_part, std::pmr::memory_resource* memory)
      : on_(on),
        memory_(memory),
        search_(on, model, each_part, memory),
        copies_(on, memory),
        there_(0, on.id, memory) {}

  /// Throws std::logic_error if the last configurations could not be placed.
  void check_placed() const {
    if (search_.placed() != asked_) throw std::logic_error("clearance: the last configurations could not be placed");
  }
  /// Waits, and copies the results to `to`. Throws std::invalid_argument if a pose is not rigid.
  void copy_out(std::vector<typename Question::result_type>& to, point_counts* counts = nullptr) const {
    to.resize(std::size_t(search_.placed()) * search_.robots());
    if (search_.copy_out(to, counts)) return;
    throw std::invalid_argument(
        poses_.empty()
            ? "clearance: a joint vector is not finite or beyond its joint's limits, or moves a part out of the world"
            : "clearance: a pose is not rigid");
  }
  template <class F>
  void named(const F& f) const {
    detail::named(search_.parts(), poses_, f);
  }

  device on_;
  std::pmr::memory_resource* memory_;
  device_batch<PartView, Question> search_;
  frames::kept_copies copies_;

 private:
  std::vector<Eigen::Isometry3d> poses_;  ///< Host copies, for error messages.
  std::size_t asked_ = 0;
  std::vector<double> q_;  ///< Joint vectors on their way,
  device_buffer<double> there_;
};

/// On a device. It takes its memory from `memory`, a resource that hands out device memory, if you give one. Results
/// stay valid until the next call.
template <class PartView, class Q>
class engine<device, PartView, Q> : public placed_batch<PartView, typename Q::searched> {
  using placed = placed_batch<PartView, typename Q::searched>;

 public:
  /// Throws std::invalid_argument if a tree is too deep for a thread's stack.
  engine(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
      : placed(on, model, Q::each_part, memory),
        widened_(on, model, memory),
        margins_(std::max<std::size_t>(model.size(), 1), on.id, memory) {}

  /// Points in host memory are copied into buffers that it keeps.
  template <class Clouds>
  const typename Q::result& run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    placed::place(poses);
    return run_placed(clouds, q);
  }
  /// The device computes the poses.
  template <class Clouds>
  const typename Q::result& run_chain(const joint_chain<device>& chain, std::span<const double> joints,
                                      const Clouds& clouds, const Q& q) {
    placed::place(chain, joints);
    return run_placed(clouds, q);
  }
  /// Asks about the placed configurations, against a new frame.
  template <class Clouds>
  const typename Q::result& run_placed(const Clouds& clouds, const Q& q) {
    placed::named([&] {
      ask(clouds, q, copies_);
      point_counts counts;
      placed::copy_out(Q::results(result_), &counts);
      Q::take_counts(result_, counts, search_.parts());
    });
    return result_;
  }
  /// Enqueues it, and returns device memory with one result per configuration, or per part of each, for the next work
  /// in its stream. Clouds must be readable there. A pose that is not rigid makes the state `possible` (and the
  /// distance NaN), because a device cannot throw. A graph that captures this keeps the current options, and is void
  /// after more configurations are placed, or a larger cloud is asked about.
  template <class Clouds>
  auto start_placed(const Clouds& clouds, const Q& q) {
    ask(clouds, q, frames::as_it_is{});
    return search_.results();
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  template <class Clouds, class Here>
  void ask(const Clouds& clouds, const Q& q, Here&& here) {
    static_assert(explain_clouds<Clouds>());
    placed::check_placed();
    auto question = q.checked(search_.parts());
    if constexpr (Q::searched::by_margin) question.vague = any_vague(clouds);
    search_.set_robot(widened_(q.radii));
    if constexpr (Q::searched::by_margin) {
      on_.stage(std::span(question.margins, question.count), margins_.data());
      question.margins = margins_.data();
    }
    search_.enqueue(clouds, question, [&](const auto& source, std::uint32_t cloud) { return here(source, cloud); });
  }

  using placed::on_, placed::search_, placed::copies_;
  widened_model<device, PartView> widened_;
  device_buffer<double> margins_;
  typename Q::result result_;
};

}  // namespace clearance::plan
