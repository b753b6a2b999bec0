// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are a robot's own, as an answer that gets pairs, and the labels that come of it.

#include <clearance/ground/ordered.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/result.hpp>

namespace clearance {

/// Whose the points of some clouds are; plain data, that a kernel may write or read.
struct self_filter_counts {
  point_counts points;
  unsigned long long own = 0, uncertain = 0;  ///< Of the valid ones.
};

namespace pairwise {

/// The answer: a bit for each point of all clouds. Once it is certain that a point is the robot's, its other parts are not asked.
struct own_points {
  std::uint32_t *own, *perhaps;      ///< All 0 beforehand.
  const real *may_be, *is;           ///< One of each a part.
  const std::uint32_t* first_point;  ///< Of each cloud.

  CLEARANCE_HD real reach(std::uint32_t part) const { return may_be[part]; }
  CLEARANCE_HD real reach(std::uint32_t part, real found, real) const { return found <= is[part] ? -infinity : is[part]; }
  CLEARANCE_HD bool settled(std::uint32_t cloud, std::uint32_t point, std::uint32_t) const {
    const std::uint32_t number = first_point[cloud] + point;
    return (load_relaxed(own + number / 32) >> number % 32 & 1) != 0;
  }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    const std::uint32_t number = first_point[pair.cloud] + pair.point;
    set_bits((pair.distance <= is[pair.part] ? own : perhaps) + number / 32, 1u << number % 32);
  }
};
static_assert(settling_answer<own_points> && coarse_answer<own_points>);

/// Before: nothing is anybody's.
struct clear_own_points {
  std::uint32_t* bits;
  self_filter_counts* counts;

  CLEARANCE_HD void operator()(std::size_t i) const {
    bits[i] = 0;
    if (i == 0) counts->own = counts->uncertain = 0;
  }
};

/// After: from bits to the labels of one cloud's points.
template <point_source Source>
struct label_points {
  Source source;
  std::uint32_t first;  ///< The number of its first point.
  const std::uint32_t *own, *perhaps;
  bool all_uncertain;  ///< Those that are not certainly the robot's.
  point_label* labels;
  self_filter_counts* counts;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const std::size_t number = first + i;
    const auto is_set = [number](const std::uint32_t* bits) { return (bits[number / 32] >> number % 32 & 1) != 0; };
    point_label label = point_label::no_point;
    if (is_set(own))
      label = point_label::own;
    else if (source[i].valid())
      label = all_uncertain || is_set(perhaps) ? point_label::uncertain : point_label::rest;
    labels[number] = label;
    if (label == point_label::own) add_one(&counts->own);
    if (label == point_label::uncertain) add_one(&counts->uncertain);
  }
};

}  // namespace pairwise

}  // namespace clearance
