// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance that several points confirm: one alone may be dust, rain, or a mixed pixel.

#include <clearance/pairwise/support.hpp>
#include <clearance/questions/nearest_points.hpp>

#include <set>

namespace clearance {

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

/// The least distance over points that have at least `min_points` - 1 other valid points of all clouds within `radius`
/// of them, by world coordinates in double. Refused: min_points or `most` of 0, `most` above 2^20, and a radius that is
/// negative or not finite.
struct min_distance_supported {
  std::uint32_t min_points = 3;  ///< A point is confirmed by this many points, itself among them,
  double radius = 0.02;          ///< within this many metres.
  std::size_t most = 4096;       ///< The search ends after this many of the nearest points, each asked once.

  using result = supported_distance;
  template <class On, class PartView>
  class engine;

  void check() const {
    if (min_points == 0 || !(radius >= 0 && radius < infinity))
      throw std::invalid_argument("clearance: a point cannot be confirmed by " + std::to_string(min_points) +
                                  " points within " + std::to_string(radius) + " m");
    if (most == 0 || most > pairwise::most_listed)
      throw std::invalid_argument("clearance: " + std::to_string(most) +
                                  " nearest points cannot be asked; it must be 1 to 2^20");
  }
};

namespace pairwise {

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

/// Numbers the points through all clouds, whose first points have the numbers `first`.
inline std::vector<std::uint32_t> numbers_of(const std::vector<std::uint32_t>& first,
                                             std::span<const pair_distance> points) {
  std::vector<std::uint32_t> numbers;
  for (const pair_distance& p : points) numbers.push_back(first[p.cloud] + p.point);
  return numbers;
}

/// Which of some points have enough others around them. Clouds must be readable where the question runs.
template <class Passes, class Clouds>
std::vector<std::uint32_t> count_around(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                        std::span<const pair_distance> points, const min_distance_supported& options) {
  const auto& on = passes.on;
  const auto facts = passes.model.facts;
  auto& memory = passes.memory;
  const auto a = passes.look(poses, clouds);
  position* const place = memory.template room<position>(points.size()).data();
  const auto both = memory.put(numbers_of(a.first, points), std::vector<std::uint32_t>(points.size()));
  std::uint32_t *const number = std::get<0>(both), *const support = std::get<1>(
                                                       both);  // clang before 16 captures no structured bindings
  frames::cloud_frame frame;
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
    static_assert(points_alone<S>());
    on.for_each(points.size(), place_candidates<S>{source, frame.world_from_cloud, now.first, number, place});
  });
  const std::vector<position> at = on.copy_out(place, points.size());
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn&) {
    std::vector<ball> balls;
    std::vector<double> all_within;
    for (const position& p : at) {
      const place_around its = around(p, options.radius, frame.world_from_cloud);
      balls.push_back(its.near), all_within.push_back(its.all_within);
    }
    const auto [near] = memory.put(balls);
    const count_support<S> each{source,
                                frame.world_from_cloud,
                                enclosing_ball(std::span<const ball>(balls)),
                                near,
                                place,
                                support,
                                std::uint32_t(points.size()),
                                options.min_points,
                                options.radius * options.radius};
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(on)>, host>)
      on.for_ranges(source.size(), count_support_of_pieces<S>{each, all_within.data()});
    else
      on.for_each(source.size(), each);
  });
  return on.copy_out(support, points.size());
}

/// Is one of some points certainly inside a part that knows its inside?
template <class Passes, class Clouds>
bool any_inside(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                std::span<const pair_distance> points) {
  using part_view = typename decltype(passes.model)::part_type;
  if constexpr (scan::has_interior<part_view>) {
    const auto& model = passes.model;
    if (points.empty()) return false;
    const auto a = passes.look(poses, clouds);
    const auto both = passes.memory.put(numbers_of(a.first, points), std::vector<std::uint32_t>(points.size()));
    std::uint32_t *const number = std::get<0>(both), *const inside = std::get<1>(both);
    frames::cloud_frame frame;
    frames::for_each_turn(
        frame, model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          const auto [places] = passes.memory.put(frame.places);
          passes.on.for_each(points.size(), find_inside<part_view, S>{model.parts, places, std::uint32_t(model.size()),
                                                                      source, frame.origin, now.first, number, inside,
                                                                      any_depth{stack_need(model.depth, model.width)}});
        });
    const std::vector<std::uint32_t> found = passes.on.copy_out(inside, points.size());
    return std::ranges::find(found, 1u) != found.end();
  }
  return false;
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
template <class Passes, class Clouds>
supported_distance least_supported(Passes& passes, known_nearest& known, std::span<const Eigen::Isometry3d> poses,
                                   const Clouds& clouds, const min_distance_supported& options) {
  options.check();
  supported_distance r;
  bool inside = false;
  for (std::size_t k = std::min<std::size_t>(16, options.most), asked = 0;; k = std::min(8 * k, options.most)) {
    const nearest_k_result near = list_nearest(passes, known, poses, clouds, k, infinity);
    const auto [points, all] = nearest_points(near);
    r.counts = near.counts;
    if (!points.empty() && r.counts.valid < options.min_points) {  // so many are nowhere
      r.state = state::possible, r.distance = infinity, r.isolated = r.counts.valid, r.nearest_isolated = points[0];
      return r;
    }
    const auto some = std::span(points).subspan(asked);
    const auto support = count_around(passes, poses, clouds, some, options);
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
      inside = inside || (r.distance == 0 && any_inside(passes, poses, clouds, within));
      const bool more = !inside && r.distance == 0 && points.back().distance == 0 &&
                        scan::has_interior<typename decltype(passes.model)::part_type>;
      if (more && !ends) continue;  // the next of them may be deeper inside
      bracket(r, near.certain, passes.model.facts[r.part].tolerance, inside);
      return r;
    }
    if (ends) {
      if (asked > 0) r.state = state::possible, r.distance = all ? infinity : not_a_number;
      return r;
    }
  }
}

}  // namespace pairwise

/// It remembers how near the nearest points were, which only makes it faster. It cannot be enqueued, because it depends
/// on the first answers how many points must be asked.
template <class On, class PartView>
class min_distance_supported::engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from) : passes_(on, model, from...) {}

  template <class Clouds>
  supported_distance run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                         const min_distance_supported& q) {
    return pairwise::least_supported(passes_, known_, poses, passes_.readable(clouds), q);
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { known_ = {}; }

 private:
  pairwise::passes<On, PartView> passes_;
  pairwise::known_nearest known_;
};

}  // namespace clearance
