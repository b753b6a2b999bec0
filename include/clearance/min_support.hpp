// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance that several points confirm: one alone may be dust, rain, or a mixed pixel. On the host; min_support.cuh has a device.

#include <clearance/answer/margins.hpp>
#include <clearance/answer/support.hpp>
#include <clearance/nearest_k.hpp>

#include <set>

namespace clearance {

struct support_options {
  std::uint32_t min_points = 3;  ///< So many points, itself among them, within
  double radius = 0.02;          ///< metres of a point confirm it.
  std::size_t most = 4096;       ///< So many of the nearest points are asked, then it is given up.
};

/// The nearest point that others confirm, and what is nearer, but alone.
struct supported_distance {
  /// Of the confirmed point, as in min_distance; possible: none is confirmed; no_data: there is no valid point.
  clearance::state state = clearance::state::no_data;
  real distance = not_a_number;  ///< Metres. Infinite: all points were asked; NaN: only the `most` nearest.
  real lower = 0;                ///< All confirmed points are certainly at least so far away; 0 if none is.
  std::uint32_t cloud = none, point = none, part = none, primitive = none;
  std::uint64_t isolated = 0;  ///< Points that come before it and are not confirmed,
  pair_distance nearest_isolated = {none, none, none, none, infinity};  ///< and the first of them.
  point_counts counts;
};

namespace detail {

/// The nearest points of a robot with their parts: by distance, cloud, point, as far as lists of each part's nearest tell; and whether that
/// is all of them.
inline std::pair<std::vector<pair_distance>, bool> nearest_points(const nearest_k_result& of_parts) {
  std::vector<pair_distance> pairs = of_parts.pairs;
  std::erase_if(pairs, [](const pair_distance& pair) { return pair.cloud == none; });
  std::sort(pairs.begin(), pairs.end(), [](const pair_distance& a, const pair_distance& b) {
    return std::tie(a.distance, a.cloud, a.point, a.part) < std::tie(b.distance, b.cloud, b.point, b.part);
  });
  bool all = true;
  for (std::size_t last = of_parts.per_part; last <= of_parts.pairs.size(); last += of_parts.per_part) all &= of_parts.pairs[last - 1].cloud == none;
  if (!all) pairs.resize(of_parts.per_part);  // of those behind, some may be missing
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  std::erase_if(pairs, [&](const pair_distance& pair) { return !seen.emplace(pair.cloud, pair.point).second; });
  return {std::move(pairs), all};
}

/// Which of some points have enough others around them. Clouds have to be readable where the question runs.
template <class Question, class Clouds>
std::vector<std::uint32_t> count_around(Question& question, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                        std::span<const pair_distance> points, const support_options& options) {
  const auto& on = question.on;
  const auto facts = question.model.facts;
  auto& memory = question.memory;
  std::vector<std::uint32_t> numbers;
  question.ahead.look(facts, poses, clouds);
  for (const pair_distance& p : points) numbers.push_back(question.ahead.first[p.cloud] + p.point);
  memory.begin();
  position* const place = memory.template room<position>(points.size()).data();
  const auto both = memory.put(numbers, std::vector<std::uint32_t>(points.size()));
  std::uint32_t *const number = std::get<0>(both), *const support = std::get<1>(both);  // clang before 16 captures no structured bindings
  frames::cloud_frame frame;
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
    on.for_each(points.size(), pairwise::place_candidates<S>{source, frame.world_from_cloud, now.first, number, place});
  });
  const std::vector<position> at = on.copy_out(place, points.size());
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn&) {
    std::vector<ball> balls;
    for (const position& p : at) balls.push_back(pairwise::around(p, options.radius, frame.world_from_cloud));
    const auto [near] = memory.put(balls);
    on.for_each(source.size(), pairwise::count_support<S>{source, frame.world_from_cloud, enclosing_ball(std::span<const ball>(balls)), near, place, support,
                                                          std::uint32_t(points.size()), options.min_points, options.radius * options.radius});
  });
  return on.copy_out(support, points.size());
}

/// Clouds have to be readable where the question runs.
template <class Question, class Clouds>
supported_distance least_supported(Question& question, known_nearest& known, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                   const support_options& options) {
  if (options.min_points == 0 || !(options.radius >= 0 && options.radius < infinity))
    throw std::invalid_argument("clearance: a point cannot be confirmed by " + std::to_string(options.min_points) + " points within " +
                                std::to_string(options.radius) + " m");
  if (options.most == 0 || options.most > most_listed)
    throw std::invalid_argument("clearance: " + std::to_string(options.most) + " nearest points cannot be asked; it must be 1 to 2^20");
  supported_distance r;
  for (std::size_t k = std::min<std::size_t>(16, options.most), asked = 0;; k = std::min(4 * k, options.most)) {
    const nearest_k_result near = list_nearest(question, known, poses, clouds, k, infinity);
    const auto [points, all] = nearest_points(near);
    const auto support = count_around(question, poses, clouds, std::span(points).subspan(asked), options);
    const auto its = std::size_t(std::find_if(support.begin(), support.end(), [&](std::uint32_t n) { return n >= options.min_points; }) - support.begin());
    asked += its;
    r.counts = near.counts, r.isolated = asked;
    if (asked > 0) r.nearest_isolated = points[0];
    if (its < support.size()) {
      const pair_distance& found = points[asked];
      r.distance = found.distance, r.cloud = found.cloud, r.point = found.point, r.part = found.part, r.primitive = found.primitive;
      min_distance_result bracketed;
      bracketed.distance = found.distance, bracketed.part = found.part;
      minimum::bracket(bracketed, minimum::certain_distance(found.distance, near.certain.slop, near.certain.error),
                       question.model.facts[found.part].tolerance, false, near.certain.error);
      bracketed.dropped[int(drop_reason::too_close)] = r.counts.dropped[int(drop_reason::too_close)];
      minimum::allow_for_too_close(bracketed);
      r.state = bracketed.state, r.lower = bracketed.lower;
      return r;
    }
    if (all || k == options.most) {
      if (asked > 0) r.state = state::possible, r.distance = all ? infinity : not_a_number;
      return r;
    }
  }
}

}  // namespace detail

/// The prepared question: made once for a robot, asked every frame with new poses, points and options. It remembers how near the nearest
/// were, which only ever makes it faster. It cannot be enqueued: how many points have to be asked is known when some have been. One object
/// is for one thread and one stream; the robot must stay.
template <class On, class PartView>
class min_distance_supported_query {
 public:
  /// `memory`, a device's alone: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  min_distance_supported_query(const On& on, const Robot& robot, Memory... memory) : question_(on, view_of(robot), memory...) {}

  /// As `min_distance_supported`. Points that a device cannot read are copied into buffers that are kept.
  template <class Clouds>
  supported_distance operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const support_options& options = {}) {
    static_assert(explain_clouds<Clouds>());
    return detail::least_supported(question_, known_, poses, question_.memory.readable(clouds), options);
  }

  /// Drops what is known of the last frame. The next one starts cold; its answer is the same.
  void forget() { known_ = {}; }

 private:
  pairwise::pair_question<On, PartView> question_;
  detail::known_nearest known_;
};
template <class On, robot Robot, class... Memory>
min_distance_supported_query(const On&, const Robot&, Memory...)
    -> min_distance_supported_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// The least distance over points that have at least `min_points` - 1 other valid points of all clouds within `radius` of them, by world
/// coordinates in double. `poses` and `clouds` as for min_distance. Throws std::invalid_argument as that does, if min_points or most is 0,
/// most is above 2^20, or the radius is negative or not finite.
template <class On, robot Robot, class Clouds>
supported_distance min_distance_supported(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                          const support_options& options = {}) {
  return pairwise::asked_once<min_distance_supported_query>(on, robot, [&](auto& query) { return query(poses, clouds, options); });
}

}  // namespace clearance
