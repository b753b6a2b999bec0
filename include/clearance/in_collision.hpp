// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is any point closer than a margin? Runs on the host; include in_collision.cuh for a device.

#include <clearance/answer/first_within.hpp>
#include <clearance/answer/margins.hpp>
#include <clearance/collect_query.hpp>

#include <array>

namespace clearance {

/// Whether a point is within a margin (elsewhere: security margin, safety distance), and which point: the same on every
/// run and backend.
struct collision_result {
  /// collision: certainly a point is. possible: a point may be. free: certainly none is, and nothing was too close to
  /// be measured. no_data: there was no valid point, or no part.
  clearance::state state = clearance::state::no_data;
  std::uint32_t cloud = none, point = none,
                part = none;  ///< The lowest certain pair (by cloud, point, part), or else the lowest possible one.
  point_counts counts;
};

namespace detail {

/// Makes the result of what a scan keeps; `result` has the counts already.
struct tell_collision {
  const unsigned long long* word;
  const std::uint32_t* first;
  std::uint32_t clouds, parts;
  collision_result* result;

  CLEARANCE_HD void operator()(std::size_t) const {
    using answer = pairwise::first_within;
    const bool too_close = result->counts.dropped[int(drop_reason::too_close)] != 0;
    result->state = result->counts.valid == 0 || parts == 0 ? state::no_data
                    : too_close                             ? state::possible
                                                            : state::free;
    result->cloud = result->point = result->part = none;
    if (*word == answer::nothing) return;
    const auto where = pairwise::place_of(std::uint32_t(*word >> 31), first, clouds);
    result->state = (*word & answer::uncertain) != 0 ? state::possible : state::collision;
    result->cloud = where.cloud, result->point = where.point, result->part = std::uint32_t(*word) & 0x7fffffff;
  }
};

}  // namespace detail

/// The prepared question: make it once for a robot, and ask it in every frame with new poses, points and margins. Use
/// one object from one thread and one stream; the robot must outlive it.
template <class On, class PartView>
class in_collision_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  in_collision_query(const On& on, const Robot& robot, Memory... memory) : question_(on, view_of(robot), memory...) {}

  /// As `in_collision`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  collision_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                              std::span<const double> margins) {
    static_assert(explain_clouds<Clouds>());
    auto& [on, model, memory, pairs, ahead] = question_;
    memory.begin();
    collision_result* const told = memory.template room<collision_result>(1).data();
    ask(poses, memory.readable(clouds), margins, told);
    return on.copy_out(told, 1)[0];
  }
  template <class Clouds>
  collision_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, double margin = 0) {
    return (*this)(poses, clouds, std::span<const double>(&margin, 1));
  }

  /// As `in_collision_async`. On a device it waits for nothing, and allocates only for more clouds than ever before. A
  /// graph that captures this keeps the current poses and margins.
  template <class Clouds>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::span<const double> margins,
               collision_result* result) {
    static_assert(explain_clouds<Clouds>());
    question_.memory.begin();
    ask(poses, clouds, margins, result);
  }
  template <class Clouds>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, double margin,
               collision_result* result) {
    enqueue(poses, clouds, std::span<const double>(&margin, 1), result);
  }

 private:
  template <class Clouds>
  void ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::span<const double> margins,
           collision_result* result) {
    auto& [on, model, memory, pairs, ahead] = question_;
    using answer = pairwise::first_within;
    pairwise::check_margins(margins, model.size());
    const frames::float_error error = ahead.look(model.facts, poses, clouds).error;
    const auto& first = ahead.first;
    auto& reaches = ahead.reaches;
    reaches.resize(2 * model.size());
    for (std::size_t k = 0; k < model.size(); ++k) {
      const double margin = margins[margins.size() == 1 ? 0 : k];
      reaches[k] = pairwise::may_be_within(margin, model.facts[k], error);
      reaches[model.size() + k] = pairwise::is_within(margin, model.facts[k], error);
    }
    const auto [word, near, start] = memory.put(std::array{answer::nothing}, reaches, first);
    question_.ask(poses, clouds, answer{word, near, near + model.size(), start}, &result->counts);
    on.for_each(1,
                detail::tell_collision{word, start, std::uint32_t(first.size()), std::uint32_t(model.size()), result});
  }

  pairwise::pair_question<On, PartView> question_;
};
template <class On, robot Robot, class... Memory>
in_collision_query(const On&, const Robot&, Memory...)
    -> in_collision_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// Is any point closer than `margins`, in metres: one for all parts, or one per part? `poses` and `clouds` as for
/// min_distance. Throws std::invalid_argument as that does, if there are neither one nor as many margins as parts, or
/// one is NaN.
template <class On, robot Robot, class Clouds>
collision_result in_collision(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                              const Clouds& clouds, std::span<const double> margins) {
  return pairwise::asked_once<in_collision_query>(on, robot,
                                                  [&](auto& query) { return query(poses, clouds, margins); });
}
/// The same with one margin for all parts.
template <class On, robot Robot, class Clouds>
collision_result in_collision(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                              const Clouds& clouds, double margin = 0) {
  return in_collision(on, robot, poses, clouds, std::span<const double>(&margin, 1));
}

/// Enqueues it; `result`, in memory that `on` writes, and clouds must stay valid until it is done.
template <class On, robot Robot, class Clouds>
void in_collision_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                        const Clouds& clouds, std::span<const double> margins, collision_result* result) {
  pairwise::asked_once<in_collision_query>(on, robot,
                                           [&](auto& query) { query.enqueue(poses, clouds, margins, result); });
}

}  // namespace clearance
