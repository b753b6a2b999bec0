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
  /// collision: certainly one is; possible: that cannot be excluded; free: certainly none, and nothing was too close to be measured; no_data: there was no valid point.
  clearance::state state = clearance::state::no_data;
  std::uint32_t cloud = none, point = none, part = none;  ///< The lowest certain one (by cloud, point, part); else the lowest possible one.
  point_counts counts;
};

/// Is any point closer than `margins`, in metres: one for all parts, or one a part? `poses` and `clouds` as for min_distance. Throws
/// std::invalid_argument as that does, if there are other than one or as many margins, or one is NaN.
template <class On, robot Robot, class Clouds>
collision_result in_collision(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                              std::span<const double> margins) {
  static_assert(explain_clouds<Clouds>());
  using answer = pairwise::first_within;
  const auto model = view_of(robot);
  if (margins.size() != 1 && margins.size() != model.size())
    throw std::invalid_argument("clearance: there are " + std::to_string(model.size()) + " parts, but " + std::to_string(margins.size()) + " margins");
  std::vector<std::uint32_t> first;
  const frames::float_error error = pairwise::look_ahead(model.facts, poses, clouds, first);
  std::vector<real> reaches(2 * model.size());
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double margin = margins[margins.size() == 1 ? 0 : k];
    if (!(margin == margin)) throw std::invalid_argument("clearance: the margin of part " + std::to_string(k) + " is not a number");
    reaches[k] = pairwise::may_be_within(margin, model.facts[k], error);
    reaches[model.size() + k] = pairwise::is_within(margin, model.facts[k], error);
  }
  auto word = staged(on, std::vector{answer::nothing});
  auto near = staged(on, reaches);
  auto start = staged(on, first);
  collision_result r;
  r.counts = collect(on, robot, poses, clouds, answer{word.data(), near.data(), near.data() + model.size(), start.data()});
  if (const unsigned long long found = on.copy_out(word.data(), 1)[0]; found != answer::nothing) {
    r.state = (found & answer::uncertain) != 0 ? state::possible : state::collision;
    std::tie(r.cloud, r.point) = pairwise::place_of(std::uint32_t(found >> 31), first);
    r.part = std::uint32_t(found) & 0x7fffffff;
  } else if (r.counts.valid != 0) {
    r.state = r.counts.dropped[int(drop_reason::too_close)] == 0 ? state::free : state::possible;
  }
  return r;
}
/// The same with one margin for all parts.
template <class On, robot Robot, class Clouds>
collision_result in_collision(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, double margin = 0) {
  return in_collision(on, robot, poses, clouds, std::span<const double>(&margin, 1));
}

}  // namespace clearance
