// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot's configuration at the time of a frame, from samples of its joints at other times.

#include <clearance/io/kinematics.hpp>

namespace clearance::io {

/// Configurations of one robot, by stamp (seconds). Between two samples values are interpolated; a joint without limits
/// takes the shorter way round. Nothing is guessed beyond `max_age`: that is a sentence.
class stamped_joints {
 public:
  /// What is known at a stamp.
  struct moment {
    std::vector<double> values;  ///< The configuration.
    double off = 0;  ///< So many seconds from it is the nearest sample; 0 between two. Times the joints' speeds it is
                     ///< what their values may be wrong by (`joint_uncertainty::delay`).
  };

  /// `max_age`: no sample that is farther from a stamp is used. Throws std::invalid_argument unless it is 0 or more.
  explicit stamped_joints(const kinematic_tree& tree, double max_age = 0.1) : max_age_(max_age) {
    if (!(max_age >= 0)) throw std::invalid_argument("max_age is " + std::to_string(max_age) + " s; it is 0 or more");
    for (std::size_t i = 0; i < tree.size(); ++i) turns_.push_back(tree.movable(i).kind == joint_kind::continuous);
  }

  /// Throws std::invalid_argument if a number is not finite, their number is wrong, or the stamp is not after the last.
  void add(double stamp, std::vector<double> values) {
    if (values.size() != turns_.size())
      throw std::invalid_argument("the robot has " + std::to_string(turns_.size()) + " values, but there are " +
                                  std::to_string(values.size()));
    for (const double x : values)
      if (!std::isfinite(x)) throw std::invalid_argument("a joint's value at " + at(stamp) + " is not finite");
    if (!std::isfinite(stamp) || !(samples_.empty() || stamp > samples_.rbegin()->first))
      throw std::invalid_argument("the stamp " + at(stamp) + " of a sample is not after the one before");
    samples_.emplace_hint(samples_.end(), stamp, std::move(values));
  }

  /// Throws std::invalid_argument if there is no sample, or if none is within `max_age` of the stamp.
  moment at_stamp(double stamp) const {
    const auto after = samples_.lower_bound(stamp);
    if (after != samples_.end() && after->first == stamp) return {after->second, 0};
    const double old = after != samples_.begin() ? stamp - std::prev(after)->first : far,
                 fresh = after != samples_.end() ? after->first - stamp : far;
    if (!(std::min(old, fresh) <= max_age_))
      throw std::invalid_argument(samples_.empty() ? "there is no sample of the joints"
                                                   : "the joints' sample that is nearest to the stamp " + at(stamp) +
                                                         " is " + std::to_string(std::min(old, fresh)) + " s " +
                                                         (old <= fresh ? "older" : "newer") + " (at most " +
                                                         std::to_string(max_age_) + " s is allowed)");
    if (std::max(old, fresh) > max_age_)
      return {(old < fresh ? std::prev(after) : after)->second, std::min(old, fresh)};
    moment between{std::prev(after)->second};
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      double step = after->second[i] - between.values[i];
      if (turns_[i]) step = std::remainder(step, 2 * pi);
      between.values[i] += old / (old + fresh) * step;
    }
    return between;
  }

 private:
  static constexpr double far = std::numeric_limits<double>::infinity(), pi = 3.14159265358979323846;

  static std::string at(double stamp) { return std::to_string(stamp) + " s"; }

  double max_age_;
  std::vector<bool> turns_;
  std::map<double, std::vector<double>> samples_;
};

}  // namespace clearance::io
