// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which parts have points in zones around them: stop, slow down, warn. Runs on the host; include zones.cuh for a
// device.

#include <clearance/answer/margins.hpp>
#include <clearance/answer/zones.hpp>
#include <clearance/collect_query.hpp>

namespace clearance {

/// One zone of one part. A point counts if it may be nearer than the zone's threshold: arithmetic, gaps and tolerances
/// are on the safe side.
struct zone {
  std::uint64_t points = 0;
  real nearest = infinity;  ///< The least distance of its points, as computed. Metres.
  std::uint32_t nearest_cloud = none,
                nearest_point = none;  ///< The point at that distance; of equally near ones the lowest.
  std::uint32_t first_cloud = none, first_point = none;  ///< The lowest of its points.
};

struct zones_options {
  std::vector<double> thresholds;  ///< Metres, in ascending order: the same for every part,
  bool each_part = false;          ///< or, if this is set, those of each part in turn, equally many.
  std::size_t min_points = 1;      ///< A zone with fewer counts as empty (`innermost`); its points are still reported.
};

struct zones_result {
  std::size_t per_part = 0, min_points = 1;
  std::vector<zone> zones;  ///< The zones of a part, the innermost first, then those of the next part.
  point_counts counts;

  const zone& of(std::size_t part, std::size_t z) const { return zones[part * per_part + z]; }
  /// The innermost zone of all parts with enough points: 0 is the nearest threshold, `per_part` means that all are
  /// empty. It is 0 for a frame without a valid point, without a part, or with something too close to be measured,
  /// because nothing is known then.
  std::size_t innermost() const {
    if (counts.valid == 0 || zones.empty() || counts.dropped[int(drop_reason::too_close)] != 0) return 0;
    std::size_t least = per_part;
    for (std::size_t i = 0; i < zones.size(); ++i)
      if (zones[i].points >= min_points) least = std::min(least, i % per_part);
    return least;
  }
};

namespace detail {

/// Makes a zone's result of what a scan keeps.
struct tell_zone {
  pairwise::count_in_zones counted;
  std::uint32_t clouds;
  zone* zones;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const pairwise::zone_words w = counted.joined(i);
    const std::uint32_t* const first = counted.first_point;
    zone z;
    z.points = w.points;
    if (w.points != 0) {
      const auto nearest = pairwise::place_of(key_index(w.nearest), first, clouds),
                 lowest = pairwise::place_of(w.first, first, clouds);
      z.nearest = key_distance(w.nearest), z.nearest_cloud = nearest.cloud, z.nearest_point = nearest.point;
      z.first_cloud = lowest.cloud, z.first_point = lowest.point;
    }
    zones[i] = z;
  }
};

/// A part's reaches: its thresholds, and how much nearer than computed a point may be.
inline void add_reaches(std::span<const double> thresholds, const part_facts& facts, const frames::float_error& error,
                        std::vector<real>& reaches) {
  for (std::size_t z = 0; z < thresholds.size(); ++z) {
    if (!(thresholds[z] >= 0) || (z > 0 && !(thresholds[z] >= thresholds[z - 1])))
      throw std::invalid_argument("clearance: a zone's threshold is " + std::to_string(thresholds[z]) +
                                  " m; they must not be negative, nor fall");
    reaches.push_back(pairwise::may_be_within(thresholds[z], facts, error));
  }
}

}  // namespace detail

/// The prepared question: make it once for a robot, and ask it in every frame with new poses, points and thresholds.
/// Use one object from one thread and one stream; the robot must outlive it.
template <class On, class PartView>
class zones_query {
 public:
  /// `memory` is for a device only: a std::pmr::memory_resource* that hands out device memory.
  template <robot Robot, class... Memory>
  zones_query(const On& on, const Robot& robot, Memory... memory) : question_(on, view_of(robot), memory...) {}

  /// As `zones`. Points that a device cannot read are copied into buffers that it keeps.
  template <class Clouds>
  zones_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                          const zones_options& options) {
    static_assert(explain_clouds<Clouds>());
    auto& [on, model, memory, pairs, ahead] = question_;
    memory.begin();
    zone* const told = memory.template room<zone>(model.size() * options.thresholds.size()).data();
    point_counts* const counts = memory.template room<point_counts>(1).data();
    zones_result all;
    all.min_points = options.min_points;
    all.per_part = ask(poses, memory.readable(clouds), options, told, counts);
    all.zones = on.copy_out(told, model.size() * all.per_part);
    all.counts = on.copy_out(counts, 1)[0];
    return all;
  }

  /// As `zones_async`. On a device it waits for nothing, and allocates only for more zones or clouds than ever before.
  /// A graph that captures this keeps the current poses and thresholds.
  template <class Clouds>
  std::size_t enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const zones_options& options,
                      zone* zones, point_counts* counts) {
    static_assert(explain_clouds<Clouds>());
    question_.memory.begin();
    return ask(poses, clouds, options, zones, counts);
  }

 private:
  template <class Clouds>
  std::size_t ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const zones_options& options,
                  zone* zones, point_counts* counts) {
    auto& [on, model, memory, pairs, ahead] = question_;
    const std::size_t given = options.thresholds.size(), parts = model.size();
    if (given == 0 || options.min_points == 0)
      throw std::invalid_argument("clearance: zones need a threshold, and min_points a point; here are " +
                                  std::to_string(given) + " and " + std::to_string(options.min_points));
    const auto& first = ahead.first;
    const frames::float_error error = ahead.look(model.facts, poses, clouds).error;
    if (options.each_part && (parts == 0 || given % parts != 0))
      throw std::invalid_argument("clearance: " + std::to_string(given) +
                                  " thresholds are not the same number for each of " + std::to_string(parts) +
                                  " parts");
    const std::size_t per_part = options.each_part ? given / parts : given;
    auto& reaches = ahead.reaches;
    reaches.clear();
    for (std::size_t k = 0; k < parts; ++k)
      detail::add_reaches(std::span(options.thresholds).subspan(options.each_part ? k * per_part : 0, per_part),
                          model.facts[k], error, reaches);
    using answer = pairwise::count_in_zones;
    auto* const words = memory.template room<pairwise::zone_words>(answer::copies * reaches.size()).data();
    on.for_each(answer::copies * reaches.size(), pairwise::empty_zones{words});
    const auto [near, start] = memory.put(reaches, first);
    const answer counted{words, near, start, std::uint32_t(per_part), std::uint32_t(reaches.size())};
    question_.ask(poses, clouds, counted, counts);
    on.for_each(reaches.size(), detail::tell_zone{counted, std::uint32_t(first.size()), zones});
    return per_part;
  }

  pairwise::pair_question<On, PartView> question_;
};
template <class On, robot Robot, class... Memory>
zones_query(const On&, const Robot&, Memory...)
    -> zones_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

/// Enqueues it. `zones`, ordered as in zones_result, and `counts` are in memory that `on` writes; clouds must stay
/// valid until it is done. Returns how many zones each part has.
template <class On, robot Robot, class Clouds>
std::size_t zones_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                        const Clouds& clouds, const zones_options& options, zone* zones, point_counts* counts) {
  return pairwise::asked_once<zones_query>(
      on, robot, [&](auto& query) { return query.enqueue(poses, clouds, options, zones, counts); });
}

/// Counts the points in zones around every part, in one pass. `poses` and `clouds` as for min_distance. Throws
/// std::invalid_argument as that does, and if thresholds are negative, not in order, none, or not the same number for
/// each part, or min_points is 0.
template <class On, robot Robot, class Clouds>
zones_result zones(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                   const zones_options& options) {
  return pairwise::asked_once<zones_query>(on, robot, [&](auto& query) { return query(poses, clouds, options); });
}

}  // namespace clearance
