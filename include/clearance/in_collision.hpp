// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is any point closer than a margin? On the host; in_collision.cuh has a device.

#include <clearance/answer/first_within.hpp>
#include <clearance/answer/margins.hpp>
#include <clearance/backend/staged.hpp>
#include <clearance/collect.hpp>

namespace clearance {

/// Whether a point is within a margin (peers: security margin, safety distance), and which: the same one on every run and backend.
struct collision_result {
  /// collision: certainly one is; possible: that cannot be excluded; free: certainly none, and nothing was too close to be measured;
  /// no_data: there was no valid point.
  clearance::state state = clearance::state::no_data;
  std::uint32_t cloud = none, point = none, part = none;  ///< The lowest certain one (by cloud, point, part); else the lowest possible one.
  point_counts counts;
};

namespace detail {

/// From what a scan keeps to what is told of it; `result` has the counts.
struct tell_collision {
  const unsigned long long* word;
  const std::uint32_t* first;
  std::uint32_t clouds;
  collision_result* result;

  CLEARANCE_HD void operator()(std::size_t) const {
    using answer = pairwise::first_within;
    const bool too_close = result->counts.dropped[int(drop_reason::too_close)] != 0;
    result->state = result->counts.valid == 0 ? state::no_data : too_close ? state::possible : state::free;
    result->cloud = result->point = result->part = none;
    if (*word == answer::nothing) return;
    const auto where = pairwise::place_of(std::uint32_t(*word >> 31), first, clouds);
    result->state = (*word & answer::uncertain) != 0 ? state::possible : state::collision;
    result->cloud = where.cloud, result->point = where.point, result->part = std::uint32_t(*word) & 0x7fffffff;
  }
};

template <class On, robot Robot, class Clouds, class Here>
void enqueue_collision(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::span<const double> margins,
                       collision_result* result, const Here& here) {
  static_assert(explain_clouds<Clouds>());
  using answer = pairwise::first_within;
  const auto model = view_of(robot);
  pairwise::check_margins(margins, model.size());
  std::vector<std::uint32_t> first;
  const frames::float_error error = pairwise::look_ahead(model.facts, poses, clouds, first);
  std::vector<real> reaches(2 * model.size());
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double margin = margins[margins.size() == 1 ? 0 : k];
    reaches[k] = pairwise::may_be_within(margin, model.facts[k], error);
    reaches[model.size() + k] = pairwise::is_within(margin, model.facts[k], error);
  }
  auto word = staged(on, std::vector{answer::nothing});
  auto near = staged(on, reaches);
  auto start = staged(on, first);
  pairwise::pairs_on<On>::once(on, model, poses, clouds, answer{word.data(), near.data(), near.data() + model.size(), start.data()}, &result->counts, here);
  on.for_each(1, tell_collision{word.data(), start.data(), std::uint32_t(first.size()), result});
}

}  // namespace detail

/// Is any point closer than `margins`, in metres: one for all parts, or one a part? `poses` and `clouds` as for min_distance. Throws
/// std::invalid_argument as that does, if there are other than one or as many margins, or one is NaN.
template <class On, robot Robot, class Clouds>
collision_result in_collision(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                              std::span<const double> margins) {
  auto told = on.template make_scratch<collision_result>(1);
  minimum::cloud_copies<On> copies;
  detail::enqueue_collision(on, robot, poses, clouds, margins, told.data(), minimum::readable_on<On>{on, copies});
  return on.copy_out(told.data(), 1)[0];
}
/// The same with one margin for all parts.
template <class On, robot Robot, class Clouds>
collision_result in_collision(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, double margin = 0) {
  return in_collision(on, robot, poses, clouds, std::span<const double>(&margin, 1));
}

/// Enqueues it; `result`, in memory that `on` writes, and clouds must stay until it is done.
template <class On, robot Robot, class Clouds>
void in_collision_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::span<const double> margins,
                        collision_result* result) {
  detail::enqueue_collision(on, robot, poses, clouds, margins, result, minimum::as_it_is{});
}

}  // namespace clearance
