// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/stamped_joints.hpp>

#include <clearance/io/kinematics.hpp>

namespace clearance::io {

stamped_joints::stamped_joints(const kinematic_tree& tree, double max_age) : max_age_(max_age) {
  if (!(max_age >= 0)) throw std::invalid_argument("max_age is " + std::to_string(max_age) + " s; it is 0 or more");
  for (std::size_t i = 0; i < tree.size(); ++i) turns_.push_back(tree.movable(i).kind == joint_kind::continuous);
}

void stamped_joints::add(double stamp, std::vector<double> values) {
  if (values.size() != turns_.size())
    throw std::invalid_argument("the robot has " + std::to_string(turns_.size()) + " values, but there are " +
                                std::to_string(values.size()));
  for (const double x : values)
    if (!std::isfinite(x)) throw std::invalid_argument("a joint's value at " + at(stamp) + " is not finite");
  if (!std::isfinite(stamp) || !(samples_.empty() || stamp > samples_.rbegin()->first))
    throw std::invalid_argument("the stamp " + at(stamp) + " of a sample is not after the one before");
  samples_.emplace_hint(samples_.end(), stamp, std::move(values));
}

stamped_joints::moment stamped_joints::at_stamp(double stamp) const {
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
  if (std::max(old, fresh) > max_age_) return {(old < fresh ? std::prev(after) : after)->second, std::min(old, fresh)};
  moment between{std::prev(after)->second};
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    double step = after->second[i] - between.values[i];
    if (turns_[i]) step = std::remainder(step, 2 * pi);
    between.values[i] += old / (old + fresh) * step;
  }
  return between;
}

}  // namespace clearance::io
