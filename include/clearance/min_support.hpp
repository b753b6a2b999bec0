// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance that several points confirm: one alone may be dust, rain, or a mixed pixel. Runs on the host;
// include min_support.cuh for a device.

#include <clearance/answer/margins.hpp>
#include <clearance/answer/support.hpp>
#include <clearance/nearest_k.hpp>

#include <set>

namespace clearance {

struct support_options {
  std::uint32_t min_points = 3;  ///< A point is confirmed by this many points, itself among them,
  double radius = 0.02;          ///< within this many metres.
  std::size_t most = 4096;       ///< The search ends after this many of the nearest points, each asked once.
};

/// The nearest point that others confirm, and the nearer points that are alone.
struct supported_distance {
  /// That of min_distance about the confirmed points that were asked. possible: none is confirmed. no_data: there is no
  /// valid point.
  clearance::state state = clearance::state::no_data;
  real distance = not_a_number;  ///< Metres. Infinite: no point is confirmed; NaN: none of the `most` nearest is.
  real lower = 0;                ///< All confirmed points are certainly at least this far away; 0 if there is none.
  std::uint32_t cloud = none, point = none, part = none, primitive = none;
  std::uint64_t isolated = 0;  ///< The number of nearer points that are not confirmed,
  pair_distance nearest_isolated = {none, none, none, none, infinity};  ///< and the first of them.
  point_counts counts;
};

namespace detail {

/// The nearest points of a robot with their parts, by distance, cloud and point, as far as the lists of each part's
/// nearest points reach, and whether these are all.
inline std::pair<std::vector<pair_distance>, bool> nearest_points(const nearest_k_result& of_parts) {
  const auto before = [](const pair_distance& a, const pair_distance& b) {
    return std::tie(a.distance, a.cloud, a.point, a.part) < std::tie(b.distance, b.cloud, b.point, b.part);
  };
  const pair_distance* last = nullptr;  // of those behind, some may be missing
  for (std::size_t end = of_parts.per_part; end <= of_parts.pairs.size(); end += of_parts.per_part)
    if (const pair_distance& its = of_parts.pairs[end - 1];
        its.cloud != none && (last == nullptr || before(its, *last)))
      last = &its;
  std::vector<pair_distance> pairs;
  for (const pair_distance& pair : of_parts.pairs)
    if (pair.cloud != none && (last == nullptr || !before(*last, pair))) pairs.push_back(pair);
  std::sort(pairs.begin(), pairs.end(), before);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  std::erase_if(pairs, [&](const pair_distance& pair) { return !seen.emplace(pair.cloud, pair.point).second; });
  if (last != nullptr) pairs.resize(of_parts.per_part);  // the list that ends first has so many
  return {std::move(pairs), last == nullptr};
}

/// Numbers the points through all clouds of the last frame.
template <class Question>
std::vector<std::uint32_t> numbers_of(const Question& question, std::span<const pair_distance> points) {
  std::vector<std::uint32_t> numbers;
  for (const pair_distance& p : points) numbers.push_back(question.ahead.first[p.cloud] + p.point);
  return numbers;
}

/// Which of some points have enough others around them. Clouds must be readable where the question runs.
template <class Question, class Clouds>
std::vector<std::uint32_t> count_around(Question& question, std::span<const Eigen::Isometry3d> poses,
                                        const Clouds& clouds, std::span<const pair_distance> points,
                                        const support_options& options) {
  const auto& on = question.on;
  const auto facts = question.model.facts;
  auto& memory = question.memory;
  question.ahead.look(facts, poses, clouds);
  memory.begin();
  position* const place = memory.template room<position>(points.size()).data();
  const auto both = memory.put(numbers_of(question, points), std::vector<std::uint32_t>(points.size()));
  std::uint32_t *const number = std::get<0>(both), *const support = std::get<1>(
                                                       both);  // clang before 16 captures no structured bindings
  frames::cloud_frame frame;
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
    on.for_each(points.size(), pairwise::place_candidates<S>{source, frame.world_from_cloud, now.first, number, place});
  });
  const std::vector<position> at = on.copy_out(place, points.size());
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn&) {
    std::vector<ball> balls;
    std::vector<double> all_within;
    for (const position& p : at) {
      const pairwise::place_around its = pairwise::around(p, options.radius, frame.world_from_cloud);
      balls.push_back(its.near), all_within.push_back(its.all_within);
    }
    const auto [near] = memory.put(balls);
    const pairwise::count_support<S> each{source,
                                          frame.world_from_cloud,
                                          enclosing_ball(std::span<const ball>(balls)),
                                          near,
                                          place,
                                          support,
                                          std::uint32_t(points.size()),
                                          options.min_points,
                                          options.radius * options.radius};
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(on)>, host>)
      on.for_ranges(source.size(), pairwise::count_support_of_pieces<S>{each, all_within.data()});
    else
      on.for_each(source.size(), each);
  });
  return on.copy_out(support, points.size());
}

/// Is one of some points certainly inside a part that knows its inside?
template <class Question, class Clouds>
bool any_inside(Question& question, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                std::span<const pair_distance> points) {
  using part_view = typename decltype(question.model)::part_type;
  if constexpr (scan::has_interior<part_view>) {
    const auto& model = question.model;
    if (points.empty()) return false;
    question.ahead.look(model.facts, poses, clouds);
    question.memory.begin();
    const auto both = question.memory.put(numbers_of(question, points), std::vector<std::uint32_t>(points.size()));
    std::uint32_t *const number = std::get<0>(both), *const inside = std::get<1>(both);
    frames::cloud_frame frame;
    frames::for_each_turn(
        frame, model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          const auto [places] = question.memory.put(frame.places);
          question.on.for_each(points.size(),
                               pairwise::find_inside<part_view, S>{model.parts, places, std::uint32_t(model.size()),
                                                                   source, frame.origin, now.first, number, inside,
                                                                   any_depth{stack_need(model.depth, model.width)}});
        });
    const std::vector<std::uint32_t> found = question.on.copy_out(inside, points.size());
    return std::ranges::find(found, 1u) != found.end();
  }
  return false;
}

inline void check(const support_options& options) {
  if (options.min_points == 0 || !(options.radius >= 0 && options.radius < infinity))
    throw std::invalid_argument("clearance: a point cannot be confirmed by " + std::to_string(options.min_points) +
                                " points within " + std::to_string(options.radius) + " m");
  if (options.most == 0 || options.most > most_listed)
    throw std::invalid_argument("clearance: " + std::to_string(options.most) +
                                " nearest points cannot be asked; it must be 1 to 2^20");
}

/// State and lower end, as of min_distance; `inside`: a confirmed point certainly is.
inline void bracket(supported_distance& r, const distance_certainty& certain, real tolerance, bool inside) {
  min_distance_result bracketed;
  bracketed.distance = r.distance, bracketed.part = r.part;
  minimum::bracket(bracketed, minimum::certain_distance(r.distance, certain.slop, certain.error), tolerance, inside,
                   certain.error);
  bracketed.dropped[int(drop_reason::too_close)] = r.counts.dropped[int(drop_reason::too_close)];
  minimum::allow_for_too_close(bracketed);
  r.state = bracketed.state, r.lower = bracketed.lower;
}

/// Clouds must be readable where the question runs.
template <class Question, class Clouds>
supported_distance least_supported(Question& question, known_nearest& known, std::span<const Eigen::Isometry3d> poses,
                                   const Clouds& clouds, const support_options& options) {
  check(options);
  supported_distance r;
  bool inside = false;
  for (std::size_t k = std::min<std::size_t>(16, options.most), asked = 0;; k = std::min(8 * k, options.most)) {
    const nearest_k_result near = list_nearest(question, known, poses, clouds, k, infinity);
    const auto [points, all] = nearest_points(near);
    r.counts = near.counts;
    if (!points.empty() && r.counts.valid < options.min_points) {  // so many are nowhere
      r.state = state::possible, r.distance = infinity, r.isolated = r.counts.valid, r.nearest_isolated = points[0];
      return r;
    }
    const auto some = std::span(points).subspan(asked);
    const auto support = count_around(question, poses, clouds, some, options);
    std::vector<pair_distance> within;  // the confirmed ones that are as near as the first of them, which may be 0
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (support[i] < options.min_points || (r.point != none && some[i].distance != r.distance)) continue;
      if (r.point == none) {
        r.distance = some[i].distance, r.cloud = some[i].cloud, r.point = some[i].point, r.part = some[i].part,
        r.primitive = some[i].primitive;
        r.isolated = asked + i;
      }
      within.push_back(some[i]);
    }
    asked = points.size();
    if (r.point == none) r.isolated = asked;
    if (r.isolated > 0) r.nearest_isolated = points[0];
    const bool ends = all || k == options.most;
    if (r.point != none) {
      inside = inside || (r.distance == 0 && any_inside(question, poses, clouds, within));
      const bool more = !inside && r.distance == 0 && points.back().distance == 0 &&
                        scan::has_interior<typename decltype(question.model)::part_type>;
      if (more && !ends) continue;  // the next of them may be deeper inside
      bracket(r, near.certain, question.model.facts[r.part].tolerance, inside);
      return r;
    }
    if (ends) {
      if (asked > 0) r.state = state::possible, r.distance = all ? infinity : not_a_number;
      return r;
    }
  }
}

}  // namespace detail

/// The prepared question: make it once for a robot, and ask it in every frame with new poses, points and options. It
/// remembers how near the nearest points were, which only makes it faster. It cannot be enqueued, because it depends on
/// the first answers how many points must be asked. Use one object from one thread and one stream; the robot must
/// outlive it.
template <class On, class PartView>
class min_distance_supported_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  min_distance_supported_query(const On& on, const Robot& robot, Memory... memory)
      : question_(on, view_of(robot), memory...) {}

  /// As `min_distance_supported`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  supported_distance operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                const support_options& options = {}) {
    static_assert(explain_clouds<Clouds>());
    return detail::least_supported(question_, known_, poses, question_.memory.readable(clouds), options);
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { known_ = {}; }

 private:
  pairwise::pair_question<On, PartView> question_;
  detail::known_nearest known_;
};
template <class On, robot Robot, class... Memory>
min_distance_supported_query(const On&, const Robot&, Memory...)
    -> min_distance_supported_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// The least distance over points that have at least `min_points` - 1 other valid points of all clouds within `radius`
/// of them, by world coordinates in double. `poses` and `clouds` as for min_distance. Throws std::invalid_argument as
/// that does, if min_points or most is 0, most is above 2^20, or the radius is negative or not finite.
template <class On, robot Robot, class Clouds>
supported_distance min_distance_supported(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                          const Clouds& clouds, const support_options& options = {}) {
  return pairwise::asked_once<min_distance_supported_query>(on, robot,
                                                            [&](auto& query) { return query(poses, clouds, options); });
}

}  // namespace clearance
