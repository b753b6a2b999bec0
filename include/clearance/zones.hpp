// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which parts have points in zones around them: stop, slow down, warn. On the host; zones.cuh has a device.

#include <clearance/answer/margins.hpp>
#include <clearance/answer/zones.hpp>
#include <clearance/backend/staged.hpp>
#include <clearance/collect.hpp>

namespace clearance {

/// One zone of one part. A point counts if it may be nearer than the zone's threshold: what arithmetic, gaps and tolerances leave
/// open is on the safe side.
struct zone {
  std::uint64_t points = 0;
  real nearest = infinity;                                  ///< The least distance of its points, as computed. Metres.
  std::uint32_t nearest_cloud = none, nearest_point = none;  ///< The point that has it; of equally near ones the lowest.
  std::uint32_t first_cloud = none, first_point = none;      ///< The lowest of its points.
};

struct zones_options {
  std::vector<double> thresholds;  ///< Metres, in ascending order: those of every part's zones,
  bool each_part = false;          ///< or, if this is set, of each part in turn, the same number of all.
  std::size_t min_points = 1;      ///< With fewer a zone counts as empty (`innermost`); they are reported all the same.
};

struct zones_result {
  std::size_t per_part = 0, min_points = 1;
  std::vector<zone> zones;  ///< Those of a part, the innermost first, then those of the next.
  point_counts counts;

  const zone& of(std::size_t part, std::size_t z) const { return zones[part * per_part + z]; }
  /// The innermost zone of all parts with enough points: 0 is the nearest threshold, `per_part` says that all are empty. Nothing is
  /// known of a frame without a valid point, or with something too close to be measured: then it is 0.
  std::size_t innermost() const {
    if (counts.valid == 0 || counts.dropped[int(drop_reason::too_close)] != 0) return 0;
    std::size_t least = per_part;
    for (std::size_t i = 0; i < zones.size(); ++i)
      if (zones[i].points >= min_points) least = std::min(least, i % per_part);
    return least;
  }
};

namespace detail {

/// From what a scan keeps of a zone to what is told of it.
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
      const auto nearest = pairwise::place_of(key_index(w.nearest), first, clouds), lowest = pairwise::place_of(w.first, first, clouds);
      z.nearest = key_distance(w.nearest), z.nearest_cloud = nearest.cloud, z.nearest_point = nearest.point;
      z.first_cloud = lowest.cloud, z.first_point = lowest.point;
    }
    zones[i] = z;
  }
};

/// A part's reaches: its thresholds, and what may be nearer than it is computed to be.
inline void add_reaches(std::span<const double> thresholds, const part_facts& facts, const frames::float_error& error, std::vector<real>& reaches) {
  for (std::size_t z = 0; z < thresholds.size(); ++z) {
    if (!(thresholds[z] >= 0) || (z > 0 && !(thresholds[z] >= thresholds[z - 1])))
      throw std::invalid_argument("clearance: a zone's threshold is " + std::to_string(thresholds[z]) + " m; they must not be negative, nor fall");
    reaches.push_back(pairwise::may_be_within(thresholds[z], facts, error));
  }
}

template <class On, robot Robot, class Clouds, class Here>
std::size_t enqueue_zones(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const zones_options& options,
                          zone* zones, point_counts* counts, const Here& here) {
  static_assert(explain_clouds<Clouds>());
  const auto model = view_of(robot);
  const std::size_t given = options.thresholds.size(), parts = model.size();
  std::vector<std::uint32_t> first;
  const frames::float_error error = pairwise::look_ahead(model.facts, poses, clouds, first);
  if (options.each_part && (parts == 0 || given % parts != 0))
    throw std::invalid_argument("clearance: " + std::to_string(given) + " thresholds are not the same number for each of " + std::to_string(parts) + " parts");
  const std::size_t per_part = options.each_part ? given / parts : given;
  std::vector<real> reaches;
  for (std::size_t k = 0; k < parts; ++k)
    add_reaches(std::span(options.thresholds).subspan(options.each_part ? k * per_part : 0, per_part), model.facts[k], error, reaches);
  auto words = on.template make_scratch<pairwise::zone_words>(pairwise::count_in_zones::copies * reaches.size());
  on.for_each(pairwise::count_in_zones::copies * reaches.size(), pairwise::empty_zones{words.data()});
  auto near = staged(on, reaches);
  auto start = staged(on, first);
  const pairwise::count_in_zones counted{words.data(), near.data(), start.data(), std::uint32_t(per_part), std::uint32_t(reaches.size())};
  pairwise::pairs_on<On>::once(on, model, poses, clouds, counted, counts, here);
  on.for_each(reaches.size(), tell_zone{counted, std::uint32_t(first.size()), zones});
  return per_part;
}

}  // namespace detail

/// Enqueues it: `zones`, as zones_result has them, and `counts`, in memory that `on` writes; clouds must stay until it is done. How many
/// zones each part has.
template <class On, robot Robot, class Clouds>
std::size_t zones_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const zones_options& options,
                        zone* zones, point_counts* counts) {
  return detail::enqueue_zones(on, robot, poses, clouds, options, zones, counts, minimum::as_it_is{});
}

/// The points in zones around every part, in one pass. `poses` and `clouds` as for min_distance. Throws std::invalid_argument as that
/// does, and if thresholds are negative, not in order, or not the same number for each part.
template <class On, robot Robot, class Clouds>
zones_result zones(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const zones_options& options) {
  const std::size_t parts = view_of(robot).size();
  auto told = on.template make_scratch<zone>(parts * options.thresholds.size());
  auto counts = on.template make_scratch<point_counts>(1);
  minimum::cloud_copies<On> copies;
  zones_result all;
  all.min_points = options.min_points;
  all.per_part = detail::enqueue_zones(on, robot, poses, clouds, options, told.data(), counts.data(), minimum::readable_on<On>{on, copies});
  all.zones = on.copy_out(told.data(), parts * all.per_part);
  all.counts = on.copy_out(counts.data(), 1)[0];
  return all;
}

}  // namespace clearance
