// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/kept_memory.cuh>
#include <clearance/plan/engine.hpp>
#include <clearance/plan/placed_batch.cuh>

namespace clearance::plan {

/// On a device. It takes its memory from `memory`, a resource that hands out device memory, if you give one. Results
/// stay valid until the next call.
template <class PartView, class Q>
class engine<device, PartView, Q> : public minimum::placed_batch<PartView, typename Q::searched> {
  using placed = minimum::placed_batch<PartView, typename Q::searched>;

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
    if constexpr (requires { question.vague; }) question.vague = any_vague(clouds);
    search_.take(widened_(q.radii));
    if constexpr (requires { question.margins; }) {
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
