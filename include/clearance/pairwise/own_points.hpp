// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are a robot's own: an answer that gets pairs.

#include <clearance/backend/few_values.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/result.hpp>

namespace clearance {

/// How many points of some clouds are the robot's. Plain data that a kernel may write or read.
struct self_filter_counts {
  point_counts points;
  unsigned long long own = 0, uncertain = 0;  ///< Of the valid points.
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
static_assert(settling_answer<own_points> && coarse_answer<own_points>);

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

}  // namespace clearance
