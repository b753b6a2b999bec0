// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from itself in many configurations, and which of its parts can meet at all?

#include <clearance/questions/min_distances.hpp>
#include <clearance/self_distance.hpp>

#include <deque>

namespace clearance {

/// Asks about many configurations of a robot. Of each pair of parts the lower one's balls get a tree once a call, in
/// the part's own frame, and the others move about it. As `self_query` otherwise.
template <class On, class PartView>
class self_queries {
 public:
  /// Throws std::invalid_argument if the pairs are of another number of parts.
  template <robot Robot>
  self_queries(const On& on, const Robot& robot, const part_pairs& pairs)
      : parts_(view_of(robot).size()), groups_(detail::parts_before_others(on, view_of(robot), pairs)) {
    for (const group& g : groups_) asks_.emplace_back(on, g.view(), min_distances{});
  }
  template <owning_robot Robot>
  self_queries(const On&, const Robot&&, const part_pairs&) = delete;  // it would be gone when it is asked; name it
  self_queries(const self_queries&) = delete;                          // what was prepared looks at its memory
  self_queries(self_queries&&) = default;

  /// `poses` are world-from-part: one for each part of the first configuration, then those of the next. One answer for
  /// each; to the bit it may differ from that of `self_query`. Throws std::invalid_argument if they are no whole
  /// configurations, or one is not rigid.
  std::vector<self_clearance> operator()(std::span<const Eigen::Isometry3d> poses) {
    if (parts_ == 0 || poses.size() % parts_ != 0)
      throw std::invalid_argument("clearance: " + std::to_string(poses.size()) +
                                  " poses are no whole configurations of " + std::to_string(parts_) + " parts");
    world_.clear();
    for (std::size_t k = 0; k < poses.size(); ++k)
      world_.push_back(rigid_transform_of(poses[k], "part", std::int64_t(k)));
    const std::size_t count = poses.size() / parts_;
    std::vector<self_clearance> all(count);
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      const group& g = groups_[k];
      solid_balls<ball_records> balls = g.balls;
      balls.tolerance += put_beside(g, count);
      const auto& found = asks_[k](beside_, placed{balls}).of;
      for (std::size_t c = 0; c < count; ++c) g.lower_to(all[c], found[c], world_[c * parts_ + g.a]);
    }
    return all;
  }
  std::vector<self_clearance> operator()(const std::vector<Eigen::Isometry3d>& poses) {
    return (*this)(std::span(poses));
  }

 private:
  using group = detail::part_before_others<On, PartView>;

  /// Composes the poses of the others in the frame of the group's part. Returns more than that costs, in metres.
  double put_beside(const group& g, std::size_t count) {
    beside_.clear();
    double ways = 0;
    for (std::size_t c = 0; c < count; ++c) {
      const world_transform* const its = world_.data() + c * parts_;
      const world_transform from_world = its[g.a].inverse();
      for (const std::uint32_t b : g.others) {
        beside_.push_back(to_isometry(from_world * its[b]));
        ways = std::max(ways, frames::norm(its[g.a].translation()) + frames::norm(its[b].translation()));
      }
    }
    return 2 * frames::pose_error * ways;
  }

  std::size_t parts_;
  std::vector<group> groups_;
  std::deque<query<min_distances, On, PartView>> asks_;  // they stay where they are
  std::vector<world_transform> world_;
  std::vector<Eigen::Isometry3d> beside_;
};
template <class On, class Robot>
self_queries(const On&, const Robot&, const part_pairs&)
    -> self_queries<On, typename detail::part_view_of<Robot>::type>;

/// The same once.
template <class On, robot Robot>
std::vector<self_clearance> self_distances(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                           const part_pairs& pairs) {
  return self_queries(on, robot, pairs)(poses);
}

/// What some configurations say of pairs: which touch in all of them, and which are never within reach of one another.
struct sampled_pairs {
  part_pairs meeting;  ///< The rest.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> always, never;
};

/// Looks at some configurations of a robot, once: `poses` as for `self_distances`, of joints that are spread over their
/// limits. Pairs that overlap or may in all of them, and those that are certainly farther apart than `reach` metres in
/// all of them, are removed from `pairs`. Samples prove nothing: what they miss, the answers miss. Throws
/// std::invalid_argument without a whole configuration, and if `reach` is negative or NaN.
template <class On, robot Robot>
sampled_pairs sample_pairs(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                           const part_pairs& pairs, double reach) {
  check_length(reach, "how near parts must come");
  const std::size_t parts = view_of(robot).size();
  if (poses.empty() || poses.size() % parts != 0)
    throw std::invalid_argument("clearance: " + std::to_string(poses.size()) +
                                " poses are no whole configurations of " + std::to_string(parts) + " parts");
  self_query ask(on, robot, pairs);
  std::vector<pair_clearance> all;
  std::vector<bool> touch, near;
  for (std::size_t c = 0; c < poses.size() / parts; ++c) {
    all = ask(poses.subspan(c * parts, parts)).pairs;
    touch.resize(all.size(), true);
    near.resize(all.size(), false);
    for (std::size_t k = 0; k < all.size(); ++k) {
      touch[k] = touch[k] && !(all[k].lower > 0);
      near[k] = near[k] || !(double(all[k].lower) > reach);
    }
  }
  sampled_pairs sampled{pairs, {}, {}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!touch[k] && near[k]) continue;
    sampled.meeting.remove(all[k].a, all[k].b);
    (touch[k] ? sampled.always : sampled.never).emplace_back(all[k].a, all[k].b);
  }
  return sampled;
}

}  // namespace clearance
