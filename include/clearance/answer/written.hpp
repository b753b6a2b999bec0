// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>

namespace clearance::pairwise {

/// An answer: writes each pair's distance in its place, part after part. Places of pairs beyond `d_max` are left alone.
struct written {
  real* distance;
  const std::uint32_t* first_point;  ///< Per cloud.
  std::size_t points;                ///< Of all clouds.
  real d_max;

  CLEARANCE_HD real reach(std::uint32_t) const { return d_max; }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    distance[pair.part * points + first_point[pair.cloud] + pair.point] = pair.distance;
  }
};
static_assert(answer<written>);

/// Before the scan: every point of a source is too far away, or no point (NaN).
template <point_source Source>
struct nothing_written {
  Source source;
  real* distance;  ///< The place of its first point and the first part.
  std::size_t points, parts;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const real none = source[i].valid() ? infinity : not_a_number;
    for (std::size_t k = 0; k < parts; ++k) distance[k * points + i] = none;
  }
};

}  // namespace clearance::pairwise
