// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot's configuration at the time of a frame, from samples of its joints at other times.

#include <clearance/io/kinematics.hpp>

#include <limits>
#include <map>
#include <string>
#include <vector>

namespace clearance::io {

/// Configurations of one robot, by stamp (seconds). Between two samples values are interpolated; a joint without limits
/// takes the shorter way round. Nothing is guessed beyond `max_age`: that is a sentence.
class stamped_joints {
 public:
  /// What is known at a stamp.
  struct moment {
    std::vector<double> values;  ///< The configuration.
    double off = 0;  ///< Seconds from the stamp to the nearest sample; 0 between two. Times the joints' speeds it is
                     ///< what their values may be wrong by (`joint_uncertainty::delay`).
  };

  /// `max_age`: no sample that is farther from a stamp is used. Throws std::invalid_argument unless it is 0 or more.
  explicit stamped_joints(const kinematic_tree& tree, double max_age = 0.1);

  /// Throws std::invalid_argument if a number is not finite, their number is wrong, or the stamp is not after the last.
  void add(double stamp, std::vector<double> values);

  /// Throws std::invalid_argument if there is no sample, or if none is within `max_age` of the stamp.
  moment at_stamp(double stamp) const;

 private:
  static constexpr double far = std::numeric_limits<double>::infinity(), pi = 3.14159265358979323846;

  static std::string at(double stamp) { return std::to_string(stamp) + " s"; }

  double max_age_;
  std::vector<bool> turns_;
  std::map<double, std::vector<double>> samples_;
};

}  // namespace clearance::io
