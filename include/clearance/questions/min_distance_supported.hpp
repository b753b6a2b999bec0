// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance that several points confirm: one alone may be dust, rain, or a mixed pixel.

#include <clearance/backends/host.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/frames/root_test.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/point_source.hpp>
#include <clearance/questions/nearest_points.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/walk_of.hpp>

#include <cmath>
#include <set>

namespace clearance::pairwise {

// Counts the points around a few candidates.

/// Computes where candidates are in the world, from their numbers through all clouds, if they are in this cloud.
template <point_source Source>
struct place_candidates {
  Source source;
  world_transform world_from_cloud;
  std::uint32_t first;
  const std::uint32_t* number;
  position* at;

  CLEARANCE_HD void operator()(std::size_t c) const {
    if (number[c] >= first && number[c] - first < source.size())
      at[c] = world_from_cloud(source[number[c] - first].position);
  }
};

/// A ball in a cloud's frame around a place in the world, safe against rounding. Points within `radius` of the place
/// are in the ball. Points within `all_within` of its middle are within `radius`; if that is negative, no point is.
struct place_around {
  ball near;
  double all_within;
};
inline place_around around(position at, double radius, const world_transform& world_from_cloud) {
  const auto norm = [](position p) { return std::hypot(p.x, p.y, p.z); };
  const position c = world_from_cloud.inverse()(at);
  const double off = radius * 0x1p-16 + 0x1p-20 * norm(c) + 0x1p-40 * (norm(at) + norm(world_from_cloud.translation()));
  return {{{real(c.x), real(c.y), real(c.z)}, rounded_up(radius + off)}, radius - off};
}

/// Counts one of a cloud's points for each candidate within the radius, in world coordinates and double. A candidate
/// counts itself. Candidates that have enough are not tested again.
template <point_source Source>
struct count_support {
  Source source;
  world_transform world_from_cloud;
  ball all;                ///< Around all balls.
  const ball* near;        ///< One per candidate.
  const position* at;      ///< One per candidate.
  std::uint32_t* support;  ///< One count per candidate: at least `enough`, if so many points are near.
  std::uint32_t candidates, enough;
  double square;  ///< The radius, squared.

  CLEARANCE_HD void operator()(std::size_t i) const {
    const sample s = source[i];
    if (!s.valid() || !may_be_in(all, s.position)) return;
    for (std::uint32_t c = 0; c < candidates; ++c)
      if (may_be_in(near[c], s.position) && load_relaxed(support + c) < enough &&
          confirms(world_from_cloud(s.position), c))
        count_one(support + c);
  }
  CLEARANCE_HD bool confirms(position p, std::uint32_t c) const {
    const position d{p.x - at[c].x, p.y - at[c].y, p.z - at[c].z};
    return fma(d.x, d.x, fma(d.y, d.y, d.z * d.z)) <= square;
  }

 private:
  CLEARANCE_HD static bool may_be_in(const ball& b, vec3 p) {
    const vec3 d = p - b.center;
    return d.x * d.x + d.y * d.y + d.z * d.z <= b.radius * b.radius * (1 + 4 * slack);
  }
};

/// The same on a host, for many neighbours at once: mostly a candidate's ball contains all of them or none.
template <point_source Source>
struct count_support_of_pieces {
  count_support<Source> each;
  const double* all_within;  ///< One per candidate.

  void operator()(indices range) const {
    with_vectors([&] {
      for (std::size_t i = range.begin; i < range.end; i += most) count(i, std::min(range.end, i + most));
    });
  }

 private:
  static constexpr std::size_t most = 1024;

  void count(std::size_t begin, std::size_t end) const {
    position at[most];
    extent box;
    std::uint32_t valid = 0;
    for (std::size_t i = begin; i < end; ++i)
      if (const sample s = each.source[i]; s.valid()) {
        box.add(s.position);
        at[valid++] = each.world_from_cloud(s.position);
      }
    if (valid == 0 || !(nearest(box, each.all.center) <= each.all.radius)) return;
    for (std::uint32_t c = 0; c < each.candidates; ++c) {
      const ball& near = each.near[c];
      if (!(nearest(box, near.center) <= near.radius) || load_relaxed(each.support + c) >= each.enough) continue;
      std::uint32_t confirming = farthest(box, near.center) <= all_within[c] ? valid : 0;
      if (confirming == 0)
        for (std::uint32_t j = 0; j < valid; ++j) confirming += each.confirms(at[j], c);
      if (confirming != 0) count_one(each.support + c, confirming);
    }
  }
  static double nearest(const extent& box, vec3 p) {
    const auto beyond = [](double low, double high, double x) { return std::fmax(std::fmax(low - x, x - high), 0); };
    return norm(beyond(box.lower.x, box.upper.x, p.x), beyond(box.lower.y, box.upper.y, p.y),
                beyond(box.lower.z, box.upper.z, p.z)) *
           (1 - 0x1p-40);
  }
  static double farthest(const extent& box, vec3 p) {
    const auto away = [](double low, double high, double x) { return std::fmax(high - x, x - low); };
    return norm(away(box.lower.x, box.upper.x, p.x), away(box.lower.y, box.upper.y, p.y),
                away(box.lower.z, box.upper.z, p.z)) *
           (1 + 0x1p-40);
  }
  static double norm(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }
};

/// Which candidates are certainly inside a part's solid.
template <class PartView, point_source Source, class Traversal>
struct find_inside {
  const PartView* parts;
  const frames::placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  std::uint32_t first;
  const std::uint32_t* number;
  std::uint32_t* inside;  ///< One per candidate; becomes 1 if it is certainly inside.
  Traversal walk;

  CLEARANCE_HD void operator()(std::size_t c) const {
    if (number[c] < first || number[c] - first >= source.size()) return;
    const vec3 p = source[number[c] - first].position - origin;
    for (std::uint32_t k = 0; k < part_count; ++k) {
      if (!frames::may_reach(places[k].around, 0, p)) continue;
      const vec3 q = places[k].part_from_cloud(p);
      if (parts[k].interior.inside(q) && scan::certainly_inside(parts[k], q, places[k].error, walk)) inside[c] = 1;
    }
  }
};

}  // namespace clearance::pairwise

namespace clearance {

/// The nearest point that others confirm, and the nearer points that are alone.
struct supported_distance {
  /// What min_distance says about the confirmed points that were asked. possible: none is confirmed. no_data: there is
  /// no valid point.
  clearance::state state = clearance::state::no_data;
  real distance = not_a_number;  ///< Metres. Infinite: no point is confirmed; NaN: none of the `most` nearest is.
  real lower = 0;                ///< All confirmed points are certainly at least this far away; 0 if there is none.
  std::uint32_t cloud = none, point = none, part = none, primitive = none;
  std::uint64_t isolated = 0;  ///< The number of nearer points that are not confirmed.
  /// The nearest of the points that are not confirmed.
  pair_distance nearest_isolated = {none, none, none, none, infinity};
  point_counts counts;
};

/// The least distance over points that have at least `min_points` - 1 other valid points of all clouds within `radius`
/// of them, by world coordinates in double. Refused: min_points or `most` of 0, `most` above 2^20, and a radius that is
/// negative or not finite.
struct min_distance_supported {
  std::uint32_t min_points = 3;  ///< How many points confirm one, itself among them.
  double radius = 0.02;          ///< Metres within which points confirm one another.
  std::size_t most = 4096;       ///< The search ends after this many of the nearest points, each asked once.

  using result = supported_distance;
  using can = clearance::can<checking, of_points>;
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
    if (const pair_distance& farthest_listed = of_parts.pairs[end - 1];
        farthest_listed.cloud != none && (last == nullptr || before(farthest_listed, *last)))
      last = &farthest_listed;
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
  const auto a = passes.prepare(poses, clouds);
  position* const place = memory.template space<position>(points.size()).data();
  const auto both = memory.put(numbers_of(a.first, points), std::vector<std::uint32_t>(points.size()));
  std::uint32_t *const number = std::get<0>(both), *const support = std::get<1>(
                                                       both);  // clang before 16 captures no structured bindings
  frames::cloud_frame frame;
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
    static_assert(points_alone<S>());
    on.for_each(points.size(), place_candidates<S>{source, frame.world_from_cloud, now.first, number, place});
  });
  const std::vector<position> at = a.copy_out(place, points.size());
  frames::for_each_turn(frame, facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn&) {
    std::vector<ball> balls;
    std::vector<double> all_within;
    for (const position& p : at) {
      const place_around near_point = around(p, options.radius, frame.world_from_cloud);
      balls.push_back(near_point.near);
      all_within.push_back(near_point.all_within);
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
  return a.copy_out(support, points.size());
}

/// Is one of some points certainly inside a part that knows its inside?
template <class Passes, class Clouds>
bool any_inside(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                std::span<const pair_distance> points) {
  using part_view = typename decltype(passes.model)::part_type;
  if constexpr (scan::has_interior<part_view>) {
    const auto& model = passes.model;
    if (points.empty()) return false;
    const auto a = passes.prepare(poses, clouds);
    const auto both = passes.memory.put(numbers_of(a.first, points), std::vector<std::uint32_t>(points.size()));
    std::uint32_t *const number = std::get<0>(both), *const inside = std::get<1>(both);
    const auto walk = scan::walk_of(passes.on, model);
    frames::cloud_frame frame;
    frames::for_each_turn(
        frame, model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          const auto [places] = passes.memory.put(frame.places);
          passes.on.for_each(points.size(), find_inside<part_view, S, std::remove_const_t<decltype(walk)>>{
                                                model.parts, places, std::uint32_t(model.size()), source, frame.origin,
                                                now.first, number, inside, walk});
        });
    const std::vector<std::uint32_t> found = a.copy_out(inside, points.size());
    return std::ranges::find(found, 1u) != found.end();
  }
  return false;
}

/// At least so far is the robot from all confirmed points. From each part's distance its own gap and tolerance are
/// taken, so that a farther pair than the nearest, `r`, may decide. Of such pairs `most` are asked.
template <class Passes, class Clouds>
double certain_of_confirmed(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                            const supported_distance& r, const distance_certainty& certain,
                            const min_distance_supported& options) {
  const auto least = [&](real distance, std::uint32_t part) {
    return frames::certain_distance(distance, certain.slops[part], certain.error);
  };
  std::vector<real> reaches;
  frames::extra_reaches(passes.model.facts, reaches);
  if (reaches.empty()) return frames::certain_distance(r.distance, certain.slop, certain.error);
  const double nearest = least(r.distance, r.part);
  if (!(r.distance > 0)) return nearest;
  for (real& reach : reaches) reach = frames::farther(r.distance, reach);
  std::vector<pair_distance> pairs = list_within(passes, poses, clouds, reaches).pairs;
  std::erase_if(pairs, [&](const pair_distance& pair) { return !(least(pair.distance, pair.part) < nearest); });
  std::ranges::sort(pairs, {}, [&](const pair_distance& pair) {
    return std::tuple(least(pair.distance, pair.part), pair.cloud, pair.point, pair.part);
  });
  for (std::size_t begin = 0, many = 16; begin < pairs.size(); begin += many, many *= 8) {
    if (begin >= options.most) return least(pairs[begin].distance, pairs[begin].part);
    const auto some = std::span<const pair_distance>(pairs).subspan(begin, std::min(many, pairs.size() - begin));
    const auto support = count_around(passes, poses, clouds, some, options);
    for (std::size_t i = 0; i < some.size(); ++i)
      if (support[i] >= options.min_points) return least(some[i].distance, some[i].part);
  }
  return nearest;
}

/// State and lower end, as of min_distance. The distance is at least `least`; `inside`: a confirmed point certainly is.
inline void bracket(supported_distance& r, double least, const distance_certainty& certain, real tolerance,
                    bool inside) {
  min_distance_result bracketed;
  bracketed.distance = r.distance;
  bracketed.part = r.part;
  frames::bracket(bracketed, least, tolerance, inside, certain.error);
  bracketed.dropped[int(drop_reason::too_close)] = r.counts.dropped[int(drop_reason::too_close)];
  frames::allow_for_too_close(bracketed);
  r.state = bracketed.state;
  r.lower = bracketed.lower;
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
      r.state = state::possible;
      r.distance = infinity;
      r.isolated = r.counts.valid;
      r.nearest_isolated = points[0];
      return r;
    }
    const auto some = std::span(points).subspan(asked);
    const auto support = count_around(passes, poses, clouds, some, options);
    std::vector<pair_distance> within;  // the confirmed ones that are as near as the first of them, which may be 0
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (support[i] < options.min_points || (r.point != none && some[i].distance != r.distance)) continue;
      if (r.point == none) {
        r.distance = some[i].distance;
        r.cloud = some[i].cloud;
        r.point = some[i].point;
        r.part = some[i].part;
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
      bracket(r, certain_of_confirmed(passes, poses, clouds, r, near.certain, options), near.certain,
              passes.model.facts[r.part].tolerance, inside);
      return r;
    }
    if (ends) {
      if (asked > 0) {
        r.state = state::possible;
        r.distance = all ? infinity : not_a_number;
      }
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
  /// Throws std::invalid_argument if the tree of a solid is too deep for `near_first` on a device.
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from) : passes_(on, model, from...) {
    if constexpr (scan::has_interior<PartView>) scan::walk_of(on, model);
  }

  /// What one pass finds decides what the next one asks.
  static constexpr bool waits = true;
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const min_distance_supported& q) {
    result_ = pairwise::least_supported(passes_, known_, poses, passes_.readable(clouds), q);
  }
  const supported_distance& finish() const { return result_; }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { known_ = {}; }

 private:
  pairwise::passes<On, PartView> passes_;
  pairwise::known_nearest known_;
  supported_distance result_;
};

}  // namespace clearance
