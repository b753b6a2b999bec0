// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which parts have points in zones around them: stop, slow down, warn.

#include <clearance/ground/numbered.hpp>
#include <clearance/query/query.hpp>
#include <clearance/robot/widened.hpp>

namespace clearance {

/// One zone of one part. A point counts if it may be nearer than the zone's threshold: arithmetic, gaps, tolerances and
/// all radii are on the safe side.
struct zone {
  std::uint64_t points = 0;  ///< How many points are in the zone.
  real nearest = infinity;   ///< The least distance of the zone's points, less their radii, as computed. Metres.
  std::uint32_t nearest_cloud = none;  ///< The cloud of the nearest point.
  std::uint32_t nearest_point = none;  ///< The nearest point's number in that cloud; of equally near ones the lowest.
  std::uint32_t first_cloud = none;    ///< The lowest cloud that has a point in the zone.
  std::uint32_t first_point = none;    ///< The lowest number in that cloud of a point in the zone.

  /// Adds the same zone's other points.
  void add(const zone& other) {
    points += other.points;
    if (std::tie(other.nearest, other.nearest_cloud, other.nearest_point) <
        std::tie(nearest, nearest_cloud, nearest_point)) {
      nearest = other.nearest;
      nearest_cloud = other.nearest_cloud;
      nearest_point = other.nearest_point;
    }
    if (std::tie(other.first_cloud, other.first_point) < std::tie(first_cloud, first_point)) {
      first_cloud = other.first_cloud;
      first_point = other.first_point;
    }
  }
};

/// What is in the zones of each part.
struct zones_result {
  std::size_t per_part = 0;    ///< The number of zones of each part.
  std::size_t min_points = 1;  ///< A zone with fewer points counts as empty (`innermost`).
  std::vector<zone> zones;     ///< The zones of a part, the innermost first, then those of the next part.
  point_counts counts;
  std::uint64_t unseen = 0;  ///< Points that there was no time for; any of them may be in any zone.

  /// Zone `z` of a part. Throws std::out_of_range if there is none.
  const zone& of(std::size_t part, std::size_t z) const& {
    check_number("part", part, per_part == 0 ? 0 : zones.size() / per_part);
    check_number("zone", z, per_part);
    return zones[part * per_part + z];
  }
  zone of(std::size_t part, std::size_t z) const&& { return of(part, z); }
  /// The innermost zone of all parts with enough points: 0 is the nearest threshold, `per_part` means that all are
  /// empty. It is 0 for a frame without a valid point, without a part, with something too close to be measured, or with
  /// unseen points, because nothing is known then.
  std::size_t innermost() const {
    if (counts.valid == 0 || zones.empty() || counts.dropped[int(drop_reason::too_close)] != 0 || unseen != 0) return 0;
    std::size_t least = per_part;
    for (std::size_t i = 0; i < zones.size(); ++i)
      if (zones[i].points >= min_points) least = std::min(least, i % per_part);
    return least;
  }
};

namespace pairwise {

/// What a scan keeps for one zone of one part, without the zones inside it. Points are numbered through all clouds.
struct zone_words {
  unsigned long long points = 0;
  distance_key nearest = no_key;  ///< The nearest point, by (distance, number).
  std::uint32_t first = ~0u;      ///< The lowest point.
};

/// The answer: zones of each part, the innermost first. A point is counted in its innermost zone. Its exact distance
/// matters only if it may be the nearest.
struct count_in_zones {
  using can = clearance::can<coarse>;
  static constexpr std::uint32_t copies =
      8;  ///< Copies of all words, so that threads do not wait for one another. They are joined at the end.

  zone_words* words;                 ///< `zones` per part, `total` per copy.
  const real* reaches;               ///< `zones` per part: how near a point must be to be counted.
  const std::uint32_t* first_point;  ///< Per cloud.
  std::uint32_t zones, total;

  CLEARANCE_HD real reach(std::uint32_t part) const {
    return zones == 0 ? -infinity : reaches[part * zones + zones - 1];
  }
  CLEARANCE_HD real reach(std::uint32_t part, real found, real nearest) const {
    const std::uint32_t z = innermost(part, found);
    return max(z == 0 ? -infinity : reaches[part * zones + z - 1], min(found, nearest));
  }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    const std::uint32_t z = innermost(pair.part, pair.distance), number = first_point[pair.cloud] + pair.point;
    if (z == zones) return;
    zone_words& zone = words[copy_for(number) * total + pair.part * zones + z];
    add_one(&zone.points);
    if (const distance_key key = make_key(pair.distance, number); key < load_relaxed(&zone.nearest))
      lower_to(&zone.nearest, key);
    if (number < load_relaxed(&zone.first)) lower_word(&zone.first, number);
  }

  /// Zone `i` of all zones, joined from all copies, with the zones inside it.
  CLEARANCE_HD zone_words joined(std::size_t i) const {
    zone_words all;
    for (std::uint32_t c = 0; c < copies; ++c)
      for (std::size_t k = i - i % zones; k <= i; ++k) {
        const zone_words& w = words[c * total + k];
        all = {all.points + w.points, w.nearest < all.nearest ? w.nearest : all.nearest,
               w.first < all.first ? w.first : all.first};
      }
    return all;
  }

 private:
  CLEARANCE_HD static std::uint32_t copy_for([[maybe_unused]] std::uint32_t number) {
#if defined(__CUDA_ARCH__)
    return blockIdx.x % copies;
#else
    return number / 1024 % copies;
#endif
  }
  /// The innermost zone that contains a point at this distance, or `zones`.
  CLEARANCE_HD std::uint32_t innermost(std::uint32_t part, real distance) const {
    std::uint32_t z = zones;
    while (z > 0 && distance <= reaches[part * zones + z - 1]) --z;
    return z;
  }
};
static_assert(explain_answer<count_in_zones>());

/// Before the scan: empties all zones.
struct empty_zones {
  zone_words* words;
  CLEARANCE_HD void operator()(std::size_t i) const { words[i] = {}; }
};

/// Makes a zone's result of what a scan keeps.
struct tell_zone {
  count_in_zones counted;
  std::uint32_t clouds;
  zone* zones;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const zone_words w = counted.joined(i);
    const std::uint32_t* const first = counted.first_point;
    zone z;
    z.points = w.points;
    if (w.points != 0) {
      const auto nearest = frames::place_of(key_index(w.nearest), first, clouds),
                 lowest = frames::place_of(w.first, first, clouds);
      z.nearest = key_distance(w.nearest);
      z.nearest_cloud = nearest.cloud;
      z.nearest_point = nearest.point;
      z.first_cloud = lowest.cloud;
      z.first_point = lowest.point;
    }
    zones[i] = z;
  }
};

/// Throws std::invalid_argument unless a part's thresholds are numbers from 0 on, in ascending order.
inline void check_thresholds(std::span<const double> thresholds) {
  for (std::size_t z = 0; z < thresholds.size(); ++z)
    if (!(thresholds[z] >= 0) || (z > 0 && !(thresholds[z] >= thresholds[z - 1])))
      throw std::invalid_argument("clearance: a zone's threshold is " + std::to_string(thresholds[z]) +
                                  " m; they must not be negative, nor fall");
}

}  // namespace pairwise

/// Counts the points in zones around every part, in one pass. Refused: thresholds that are negative, not in order, none
/// or not the same number for each part, `min_points` of 0, and radii as in_collision.
struct zones {
  std::vector<double> thresholds;  ///< Metres, in ascending order: the same for every part, unless `each_part` is set.
  bool each_part = false;          ///< `thresholds` are those of each part in turn, equally many.
  std::size_t min_points = 1;      ///< A zone with fewer counts as empty (`innermost`); its points are still reported.
  std::vector<double> radii = {};  ///< By how much parts may be elsewhere, in metres: all alike, or each.

  using result = zones_result;
  using can = clearance::can<checking, concluding, skipping, numbering, merging, partial>;
  /// Zones ordered as in the result, in memory that the backend writes.
  struct out {
    zone* zones;
    point_counts* counts;
  };

  void check() const {
    if (thresholds.empty() || min_points == 0)
      throw std::invalid_argument("clearance: zones need a threshold, and min_points a point; here are " +
                                  std::to_string(thresholds.size()) + " and " + std::to_string(min_points));
    if (!each_part) pairwise::check_thresholds(thresholds);
  }
  void check(std::size_t parts) const {
    const std::size_t each = per_part(parts);
    if (each_part)
      for (std::size_t k = 0; k < parts; ++k) pairwise::check_thresholds(std::span(thresholds).subspan(k * each, each));
    check_radii(radii, parts);
  }
  /// How many zones a part has.
  std::size_t per_part(std::size_t parts) const {
    check();
    const std::size_t given = thresholds.size();
    if (each_part && (parts == 0 || given % parts != 0))
      throw std::invalid_argument("clearance: " + std::to_string(given) +
                                  " thresholds are not the same number for each of " + std::to_string(parts) +
                                  " parts");
    return each_part ? given / parts : given;
  }

  template <class Asked>
  out space(const Asked& a) const {
    return {a.template space<zone>(a.parts() * per_part(a.parts())), a.template space<point_counts>(1)};
  }
  template <class Asked>
  pairwise::count_in_zones prepare(const Asked& a, const out&) const {
    check(a.parts());
    const std::size_t each = per_part(a.parts());
    a.reaches.clear();
    for (std::size_t k = 0; k < a.parts(); ++k)
      for (const double threshold : std::span(thresholds).subspan(each_part ? k * each : 0, each))
        a.reaches.push_back(frames::may_be_within(threshold, widened(a.facts[k], radius_of(radii, k)), a.frame.error));
    using answer = pairwise::count_in_zones;
    const std::size_t words = answer::copies * a.reaches.size();
    auto* const empty = a.template space<pairwise::zone_words>(words);
    a.on.for_each(words, pairwise::empty_zones{empty});
    const auto [near, start] = a.put(a.reaches, a.first);
    return {empty, near, start, std::uint32_t(each), std::uint32_t(a.reaches.size())};
  }
  template <class Asked>
  void conclude(const Asked& a, const pairwise::count_in_zones& counted, const out& to) const {
    a.on.for_each(counted.total, pairwise::tell_zone{counted, std::uint32_t(a.first.size()), to.zones});
  }
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    result r;
    r.per_part = per_part(a.parts());
    r.min_points = min_points;
    a.bring(backends::read_array{r.zones, from.zones, a.parts() * r.per_part},
            backends::read_value{r.counts, from.counts});
    return r;
  }

  /// No farther point of a part matters.
  real reach(std::size_t part, std::size_t parts, const part_facts& facts, const frames::float_error& error) const {
    const std::size_t each = per_part(parts);
    return frames::may_be_within(thresholds[(each_part ? part * each : 0) + each - 1],
                                 widened(facts, radius_of(radii, part)), error);
  }
  static void set_counts(result& r, const point_counts& counts) { r.counts = counts; }
  static void place_in_whole(result& r, const piece_place& place) {
    for (zone& z : r.zones) {
      if (z.nearest_cloud != none) z.nearest_point += place.first[z.nearest_cloud];
      if (z.first_cloud != none) z.first_point += place.first[z.first_cloud];
    }
  }
  static void merge(result& whole, const result& other) {
    for (std::size_t i = 0; i < whole.zones.size(); ++i) whole.zones[i].add(other.zones[i]);
    whole.counts.add(other.counts);
  }
  /// Zones hold at least these points; none is known to be empty.
  static void so_far(result& r, std::uint64_t unseen) { r.unseen = unseen; }
};

}  // namespace clearance
