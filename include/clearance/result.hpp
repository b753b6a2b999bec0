// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a question answers: the least distance, its bracket and its witness, and what they mean for a robot.

#include <clearance/concepts.hpp>
#include <clearance/ground/pose.hpp>

namespace clearance {

/// What a bracket means for a robot that is about to move.
enum class state : std::uint8_t {
  free,       ///< lower > 0: no valid point touches the robot.
  possible,   ///< The bracket contains 0; nothing else is certain.
  collision,  ///< Some point is certainly inside.
  no_data,    ///< There was no valid point: nothing is known.
  unknown,    ///< The robot reaches into room that no camera sees (`unseen`).
};

inline const char* to_string(state s) {
  constexpr const char* names[] = {"free", "possible", "collision", "no_data", "unknown"};
  return names[int(s)];
}

inline constexpr std::uint32_t none = ~0u;

/// The least distance of one part. Without a valid point within its bound it is infinite, at no point.
struct part_minimum {
  real distance = infinity;
  std::uint32_t cloud = none, point = none, primitive = none;
};

/// The pair that attains a part's least distance, in world coordinates, as in a min_distance_result. Without a pair the
/// numbers are `none` and the distance is infinite.
struct part_witness {
  real distance = infinity;
  std::uint32_t part = none, cloud = none, point = none, primitive = none;
  position at = {0, 0, 0}, nearest = {0, 0, 0};
  vec3 normal = {0, 0, 0};
};

/// How many points a scan has seen, how many of them are valid, and why the others are not.
struct point_counts {
  std::uint64_t seen = 0, valid = 0;
  std::uint64_t dropped[drop_reasons] = {};  ///< How many points were dropped, by drop_reason; [none] stays 0.

  /// Adds those of other points.
  CLEARANCE_HD void add(const point_counts& other) {
    seen += other.seen;
    valid += other.valid;
    for (int k = 0; k < drop_reasons; ++k) dropped[k] += other.dropped[k];
  }
};

/// The clearance of a robot, its bracket and its witness; plain data that a kernel may write or read.
///
/// `lower <= distance to the solid <= upper` (0 inside it), float errors included. With `no_data` the distance is NaN,
/// lower 0 and upper infinite, so that `if (r.lower < margin) stop()` stops.
struct min_distance_result {
  clearance::state state = clearance::state::no_data;
  real distance = not_a_number;  ///< Metres; to sphere parts signed, to triangle parts 0 inside.
  real lower = 0, upper = infinity;
  std::uint32_t cloud = none;      ///< The number of the nearest point's cloud.
  std::uint32_t point = none;      ///< The number of the nearest point in its cloud.
  std::uint32_t part = none;       ///< The number of the nearest part.
  std::uint32_t primitive = none;  ///< The number of the part's nearest primitive; of equally near ones the lowest.
  position at = {0, 0, 0};         ///< The nearest point, in world coordinates.
  position nearest = {0, 0, 0};    ///< The primitive's point that is nearest to it, in world coordinates.
  vec3 normal = {0, 0, 0};         ///< The unit vector from robot to point; (0,0,0) if there is none.
  std::uint64_t seen = 0, valid = 0;
  std::uint64_t dropped[drop_reasons] = {};  ///< How many points were dropped, by drop_reason; [none] stays 0.
};
static_assert(std::is_trivially_copyable_v<min_distance_result>);

}  // namespace clearance
