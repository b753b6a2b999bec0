// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are the robot itself?

#include <clearance/backends/kept_memory.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/pointwise/joined_points.hpp>
#include <clearance/query/query.hpp>
#include <clearance/result.hpp>

#include <cmath>

namespace clearance {

// Which points are a robot's own: an answer that gets pairs.

/// How many points of some clouds are the robot's. Plain data that a kernel may write or read.
struct self_filter_counts {
  point_counts points;
  unsigned long long own = 0;        ///< How many valid points are certainly the robot's.
  unsigned long long uncertain = 0;  ///< How many valid points are perhaps the robot's.
};

namespace pairwise {

/// Within `may_be(k)` of part k a point may be the robot's; within `is(k)` it certainly is.
struct paddings {
  static constexpr std::uint32_t few = 12;
  backends::few_values<real, 2 * few> values;  ///< `may_be` of all parts, then `is` of all.
  std::uint32_t parts;

  CLEARANCE_HD real may_be(std::uint32_t k) const { return values[k]; }
  CLEARANCE_HD real is(std::uint32_t k) const { return values[parts + k]; }
};

/// The answer: a label for each point of all clouds. Once a point is certainly the robot's, the other parts are not
/// asked.
struct own_points {
  using can = clearance::can<settling, coarse, labelling>;
  static constexpr std::uint32_t few_clouds = 4;

  point_label* labels;  ///< Initially `whose_alone`: what a point is if no part is near it.
  self_filter_counts* counts;
  paddings near;
  backends::few_values<std::uint32_t, few_clouds> first_point;  ///< Per cloud.
  bool all_uncertain;  ///< Every valid point that is not certainly the robot's is uncertain.

  CLEARANCE_HD real reach(std::uint32_t part) const { return near.may_be(part); }
  CLEARANCE_HD real reach(std::uint32_t part, real found, real) const {
    return found <= near.is(part) ? -infinity : near.is(part);
  }
  CLEARANCE_HD bool settled(std::uint32_t cloud, std::uint32_t point, std::uint32_t) const {
    return load_relaxed(label_of(cloud, point)) == point_label::own;
  }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    point_label* const label = label_of(pair.cloud, pair.point);
    if (is_late(pair))
      *label = point_label::own;
    else if (load_relaxed(label) != point_label::own)
      *label = point_label::uncertain;
  }

  /// The label of a point that is near no part.
  CLEARANCE_HD point_label whose_alone(bool valid) const {
    return !valid ? point_label::no_point : all_uncertain ? point_label::uncertain : point_label::rest;
  }
  CLEARANCE_HD point_label* label_of(std::uint32_t cloud, std::uint32_t point) const {
    return labels + first_point[cloud] + point;
  }
  /// True for a certain pair. It comes after its point's other pairs, so that its label is not overwritten.
  CLEARANCE_HD bool is_late(const pair_distance& pair) const { return pair.distance <= near.is(pair.part); }
};
static_assert(explain_answer<own_points>());

/// Before a scan that does not meet every point: sets the counts to 0,
struct forget_labels {
  self_filter_counts* counts;
  CLEARANCE_HD void operator()(std::size_t) const { counts->own = counts->uncertain = 0; }
};
/// labels one cloud's points,
template <point_source Source>
struct label_alone {
  own_points answer;
  Source source;
  std::uint32_t cloud;

  CLEARANCE_HD void operator()(std::size_t i) const {
    *answer.label_of(cloud, std::uint32_t(i)) = answer.whose_alone(source[i].valid());
  }
};

/// and counts the labels afterwards.
struct count_labels {
  own_points answer;

  CLEARANCE_HD void operator()(std::size_t i) const {
    if (answer.labels[i] == point_label::own) add_one(&answer.counts->own);
    if (answer.labels[i] == point_label::uncertain) add_one(&answer.counts->uncertain);
  }
};

}  // namespace pairwise

/// Whose each point is. A point is the robot's if it is certainly within the padding of a part's solid. If gap,
/// tolerance or rounding leave that open, it is `uncertain` and not hidden: a point hidden wrongly may be an obstacle,
/// a point kept wrongly stops a robot. Without a certificate every other point is uncertain.
struct self_filter_result {
  arriving<point_label> labels;      ///< Whose each point is, in the order of the clouds and their points.
  std::vector<std::size_t> offsets;  ///< The labels of cloud c are offsets[c] to offsets[c + 1] - 1.
  std::vector<std::uint32_t> rest;   ///< The numbers of all valid points that are not hidden, ascending.
  self_filter_counts counts;
};

namespace pairwise {

/// Throws std::invalid_argument if there is neither one padding nor one per part, or if one is negative or not finite.
inline void check_paddings(std::span<const double> padding, std::size_t parts) {
  if (padding.size() != 1 && padding.size() != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but " +
                                std::to_string(padding.size()) + " paddings");
  for (std::size_t k = 0; k < padding.size(); ++k)
    if (!(padding[k] >= 0 && padding[k] < double(infinity)))
      throw std::invalid_argument("clearance: the padding of part " + std::to_string(k) + " is " +
                                  std::to_string(padding[k]) + " m; it must be finite, and not negative");
}

/// How near points must be to each part to be perhaps the robot's, and certainly. True if all others are uncertain, so
/// that nobody need ask which.
inline bool set_paddings(std::span<const double> padding, std::span<const part_facts> facts,
                         const frames::float_error& error, std::vector<real>& reaches) {
  const std::size_t parts = facts.size();
  check_paddings(padding, parts);
  reaches.resize(2 * parts);
  bool all_uncertain = false;
  for (std::size_t k = 0; k < parts; ++k) {
    const double metres = padding[padding.size() == 1 ? 0 : k];
    reaches[parts + k] = frames::is_within(metres, facts[k], error);
    reaches[k] = frames::may_be_within(metres, facts[k], error);
    if (!(reaches[k] < infinity)) {
      all_uncertain = true;
      reaches[k] = reaches[parts + k];
    }
  }
  return all_uncertain;
}

/// Numbers of the valid points that are not hidden.
inline void list_rest(self_filter_result& r) {
  r.rest.clear();
  r.rest.reserve(std::size_t(r.counts.points.valid - r.counts.own));
  for (std::size_t i = 0; i < r.labels.size(); ++i)
    if (r.labels[i] == point_label::rest || r.labels[i] == point_label::uncertain) r.rest.push_back(std::uint32_t(i));
}

template <class Q>
class joined_labels {
 public:
  joined_labels(const Q&, std::span<const part_facts>) {}

  void add(const self_filter_result& piece, const piece_place& place) {
    pointwise::place_entries(piece.labels, place, all_.labels);
    all_.counts.points.add(piece.counts.points);
    all_.counts.own += piece.counts.own;
    all_.counts.uncertain += piece.counts.uncertain;
    all_.offsets = {0};
    for (const std::uint32_t size : place.whole) all_.offsets.push_back(all_.offsets.back() + size);
  }
  self_filter_result result() {
    list_rest(all_);
    return std::move(all_);
  }

 private:
  self_filter_result all_;
};

}  // namespace pairwise

/// Which points are the robot itself? Refused: neither one nor as many paddings as parts, and one that is negative or
/// not finite.
struct self_filter {
  /// Metres around a part that belong to the robot: one number for all parts, or one per part. It has to cover the
  /// error of points on the robot's surface: noise, calibration, and the gap of the part's spheres.
  std::vector<double> padding = {0.01};

  using result = self_filter_result;
  using can = clearance::can<checking, counting, concluding, joining, of_points>;
  /// One label per point of all clouds, in memory that the backend writes. The next work in a stream may ask about
  /// `masked_clouds(clouds, labels)`.
  struct out {
    point_label* labels;
    self_filter_counts* counts;
  };
  template <class PartView>
  using joined = pairwise::joined_labels<self_filter>;

  void check(std::size_t parts) const { pairwise::check_paddings(padding, parts); }

  template <class Asked>
  out space(const Asked& a) const {
    return {a.template space<point_label>(a.points), a.template space<self_filter_counts>(1)};
  }
  static point_counts* counts_of(const out& to) { return &to.counts->points; }
  template <class Asked, class Clouds>
  pairwise::own_points prepare(const Asked& a, const out& to, const Clouds& clouds) const {
    using answer = pairwise::own_points;
    for_each_cloud(clouds, []<point_source S>(const S&, const Eigen::Isometry3d&) {
      static_assert(points_alone<S>());  // what may be elsewhere is not certainly the robot's
    });
    const bool all_uncertain = pairwise::set_paddings(padding, a.facts, a.frame.error, a.reaches);
    const auto near = backends::few_or_kept<2 * pairwise::paddings::few>(a.reaches, a.memory);
    const auto start = backends::few_or_kept<answer::few_clouds>(a.first, a.memory);
    const answer own{to.labels, to.counts, {near, std::uint32_t(a.parts())}, start, all_uncertain};
    if constexpr (!Asked::meets_points) {
      a.on.for_each(1, pairwise::forget_labels{to.counts});
      std::uint32_t cloud = 0;
      for_each_cloud(clouds, [&]<point_source S>(const S& source, const Eigen::Isometry3d&) {
        a.on.for_each(source.size(), pairwise::label_alone<S>{own, source, cloud++});
      });
    }
    return own;
  }
  template <class Asked>
  void conclude(const Asked& a, const pairwise::own_points& own, const out&) const {
    if constexpr (!Asked::meets_points) a.on.for_each(a.points, pairwise::count_labels{own});
  }
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    result r{.labels = arriving<point_label>(a.arrivals()), .offsets = {}, .rest = {}, .counts = {}};
    a.bring(backends::read_array{r.labels, from.labels, a.points}, backends::read_value{r.counts, from.counts});
    r.offsets.assign(a.first.begin(), a.first.begin() + std::ptrdiff_t(a.clouds));
    r.offsets.push_back(a.points);
    pairwise::list_rest(r);
    return r;
  }
};

}  // namespace clearance
