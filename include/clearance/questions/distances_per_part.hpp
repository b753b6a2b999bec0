// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point from every part?

#include <clearance/ground/numbered.hpp>
#include <clearance/pointwise/joined_points.hpp>
#include <clearance/query/query.hpp>

namespace clearance {

/// Each part's distance to all points: those of part k are of(k), in the order of the clouds and their points.
struct part_distances {
  arriving<real> distance;  ///< Metres: to sphere parts signed, to triangle parts 0 inside; `+inf` beyond d_max, NaN
                            ///< where there is no point.
  std::size_t points = 0;   ///< The number of points of all clouds.
  point_counts counts;
  distance_certainty certain;  ///< What is certain of each distance, by its part.
  std::size_t parts = 0;       ///< The number of parts.

  /// The distances of a part to all points. Throws std::out_of_range if there is no such part.
  std::span<const real> of(std::size_t part) const& {
    check_number("part", part, parts);
    return std::span(distance).subspan(part * points, points);
  }
  /// A copy: a temporary result is gone before a view of it is read.
  std::vector<real> of(std::size_t part) const&& {
    const auto view = of(part);
    return {view.begin(), view.end()};
  }
};

namespace pairwise {

/// An answer: writes each pair's distance in its place, part after part. Places of pairs beyond `d_max` are left alone.
struct written {
  using can = clearance::can<>;
  real* distance;
  const std::uint32_t* first_point;  ///< Per cloud.
  std::size_t points;                ///< The number of points of all clouds.
  real d_max;

  CLEARANCE_HD real reach(std::uint32_t) const { return d_max; }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    distance[pair.part * points + first_point[pair.cloud] + pair.point] = pair.distance;
  }
};
static_assert(explain_answer<written>());

/// Before the scan: every point of a source is too far away, or no point (NaN).
template <point_source Source>
struct nothing_written {
  Source source;
  real* distance;  ///< The place of the source's first point and the first part.
  std::size_t points, parts;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const real none = source[i].valid() ? infinity : not_a_number;
    for (std::size_t k = 0; k < parts; ++k) distance[k * points + i] = none;
  }
};

/// Joins the rows of pieces.
template <class Q>
class joined_rows {
 public:
  joined_rows(const Q&, std::span<const part_facts> facts) { all_.parts = facts.size(); }

  void add(const typename Q::result& piece, const piece_place& place) {
    pointwise::place_entries(piece.distance, place, all_.distance, all_.parts);
    all_.points = all_.parts == 0 ? 0 : all_.distance.size() / all_.parts;
    all_.counts.add(piece.counts);
    all_.certain.widen(piece.certain);
  }
  typename Q::result result() { return std::move(all_); }

 private:
  typename Q::result all_;
};

}  // namespace pairwise

/// Every point's distance to every part: parts times points numbers. Refused: d_max that is NaN.
struct distances_per_part {
  double d_max = infinity;  ///< Metres; farther points are `+inf`.

  using result = part_distances;
  using can = clearance::can<checking, joining>;
  /// Part k's distances go to `distance[k * points]` and on, in memory that the backend writes.
  struct out {
    real* distance;
    point_counts* counts;
  };
  template <class PartView>
  using joined = pairwise::joined_rows<distances_per_part>;

  void check() const { frames::largest_within(d_max); }

  template <class Asked>
  out space(const Asked& a) const {
    return {a.template space<real>(a.points * a.parts()), a.template space<point_counts>(1)};
  }
  template <class Asked, class Clouds>
  pairwise::written prepare(const Asked& a, const out& to, const Clouds& clouds) const {
    const real most = frames::largest_within(d_max);
    real* to_distance = to.distance;
    for_each_cloud(clouds, [&]<point_source S>(const S& source, const Eigen::Isometry3d&) {
      a.on.for_each(source.size(), pairwise::nothing_written<S>{source, to_distance, a.points, a.parts()});
      to_distance += source.size();
    });
    const auto [start] = a.put(a.first);
    return {to.distance, start, a.points, most};
  }
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    result r{.distance = arriving<real>(a.arrivals()),
             .points = a.points,
             .counts = {},
             .certain = a.certain(),
             .parts = a.parts()};
    a.bring(backends::read_array{r.distance, from.distance, a.points * a.parts()},
            backends::read_value{r.counts, from.counts});
    return r;
  }
};

}  // namespace clearance
