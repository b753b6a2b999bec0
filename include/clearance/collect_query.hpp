// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Prepared questions about pairs of a point and a part. Runs on the host; include collect_query.cuh for a device.

#include <clearance/answer/asked_once.hpp>
#include <clearance/answer/bracket.hpp>
#include <clearance/answer/kept_memory.hpp>
#include <clearance/answer/margins.hpp>
#include <clearance/collect.hpp>

namespace clearance {

namespace pairwise {

/// What every prepared question about pairs has: a robot, ready to be asked about, and memory that is kept, on the
/// backend and on the host.
template <class On, class PartView>
struct pair_question {
  On on;
  model_view<PartView> model;
  kept_memory<On> memory;
  typename pairs_on<On>::template kept<PartView> pairs;
  frame_ahead ahead;

  template <class... Memory>
  pair_question(const On& on, const model_view<PartView>& model, Memory... from)
      : on(on), model(model), memory(on, from...), pairs{on, model, from...} {}

  /// Enqueues it; clouds must be readable where it runs.
  template <class Clouds, answer Answer>
  void ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer, point_counts* counts) {
    pairs.enqueue(poses, clouds, answer, counts, minimum::as_it_is{});
  }
  /// The same; blocks until it is done.
  template <class Clouds, answer Answer>
  point_counts count(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer) {
    point_counts* const counts = memory.template room<point_counts>(1).data();
    ask(poses, clouds, answer, counts);
    return on.copy_out(counts, 1)[0];
  }
  /// What is certain of distances, before a question is asked.
  template <class Clouds>
  distance_certainty certain(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    return certainty_of(ahead.look(model.facts, poses, clouds));
  }
};

}  // namespace pairwise

/// `collect`, prepared: make it once for a robot, and ask it in every frame with new poses, points and answers. Use one
/// object from one thread and one stream; the robot must outlive it.
template <class On, class PartView>
class collect_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  collect_query(const On& on, const Robot& robot, Memory... memory) : question_(on, view_of(robot), memory...) {}

  /// As `collect`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds, class Answer>
  point_counts operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer) {
    static_assert(explain_answer<Answer>() && explain_clouds<Clouds>());
    question_.memory.begin();
    return question_.count(poses, question_.memory.readable(clouds), answer);
  }

  /// As `collect_async`. On a device it is one kernel per cloud, allocates nothing and waits for nothing. A graph that
  /// captures this keeps the current poses.
  template <class Clouds, class Answer>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer,
               point_counts* counts) {
    static_assert(explain_answer<Answer>() && explain_clouds<Clouds>());
    question_.ask(poses, clouds, answer, counts);
  }

 private:
  pairwise::pair_question<On, PartView> question_;
};
template <class On, robot Robot, class... Memory>
collect_query(const On&, const Robot&, Memory...)
    -> collect_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
