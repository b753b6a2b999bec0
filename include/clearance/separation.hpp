// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How fast a gap closes, and how wide ISO/TS 15066 wants it to be. This is arithmetic, not a safety function.

#include <clearance/gradient.hpp>

#include <optional>
#include <string>
#include <utility>

namespace clearance {

/// How fast the least distance of a min_distance_result or part_witness shrinks, in metres per second; negative if the
/// pair moves apart. Its part has `velocity` at `about` and turns by `turning` (rad/s), in world axes; `point_velocity`
/// is the point's, if known. No value where the distance has no gradient. Other pairs may close faster. Throws
/// std::invalid_argument if a number is not finite.
template <class Witness>
std::optional<double> approach_speed(const Witness& w, const Eigen::Vector3d& velocity, const Eigen::Vector3d& turning,
                                     const Eigen::Vector3d& about,
                                     const Eigen::Vector3d& point_velocity = Eigen::Vector3d::Zero()) {
  if (!velocity.allFinite() || !turning.allFinite() || !about.allFinite() || !point_velocity.allFinite())
    throw std::invalid_argument("clearance: a velocity, or the point that it is of, has a number that is not finite");
  if (!gradient(w, about)) return std::nullopt;
  const Eigen::Vector3d nearest(w.nearest.x, w.nearest.y, w.nearest.z), normal(w.normal.x, w.normal.y, w.normal.z);
  return normal.dot(velocity + turning.cross(nearest - about) - point_velocity);
}

/// The terms of the protective separation distance of ISO/TS 15066, since 2025 in ISO 10218-2 (speed and separation
/// monitoring). No term has a default: measure each or take it from the standard. A missing term is refused.
struct separation_terms {
  double human_speed = not_a_number;        ///< v_h: the human's speed towards the robot, m/s.
  double robot_speed = not_a_number;        ///< v_r: the robot's speed towards the human, m/s; 0 if it moves away.
  double reaction_time = not_a_number;      ///< T_r: from the exposure of a frame to the beginning of the stop, s.
  double stopping_time = not_a_number;      ///< T_s: from the beginning of the stop to standstill, s.
  double stopping_distance = not_a_number;  ///< S_s: how far the robot moves in `stopping_time`, m.
  double intrusion = not_a_number;          ///< C: how far a body may reach before it is seen, m.
  double human_uncertainty = not_a_number;  ///< Z_d: how wrong the sensors may be about where the human is, m.
  double robot_uncertainty = not_a_number;  ///< Z_r: how wrong it may be where the robot is, m.
};

/// S_p = S_h + S_r + S_s + C + Z_d + Z_r in metres, with S_h = v_h (T_r + T_s) and S_r = v_r T_r, speeds being
/// constant. Compare it with a result's `lower`. It is the standard's formula and nothing more: no certified safety
/// function, no substitute for a risk assessment, and only as good as your numbers. Throws std::invalid_argument if one
/// is negative, NaN or infinite.
inline double protective_separation(const separation_terms& s) {
  const std::pair<const char*, double> all[] = {{"human_speed", s.human_speed},
                                                {"robot_speed", s.robot_speed},
                                                {"reaction_time", s.reaction_time},
                                                {"stopping_time", s.stopping_time},
                                                {"stopping_distance", s.stopping_distance},
                                                {"intrusion", s.intrusion},
                                                {"human_uncertainty", s.human_uncertainty},
                                                {"robot_uncertainty", s.robot_uncertainty}};
  for (const auto& [name, value] : all)
    if (!(value >= 0 && value < double(infinity)))
      throw std::invalid_argument("clearance: the " + std::string(name) + " of a separation is " +
                                  std::to_string(value) + "; it must be finite and not negative");
  const double human = s.human_speed * (s.reaction_time + s.stopping_time), robot = s.robot_speed * s.reaction_time;
  return human + robot + s.stopping_distance + s.intrusion + s.human_uncertainty + s.robot_uncertainty;
}

}  // namespace clearance
