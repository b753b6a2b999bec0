// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/kinematics.hpp>

#include <clearance/ground/chain_rounding.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearance::io {

Eigen::Isometry3d carried(const Eigen::Isometry3d& outer, const Eigen::Isometry3d& inner, const std::string& who) {
  const Eigen::Isometry3d made = outer * inner;
  chain_rounding rounding;
  rounding.turned();
  rounding.step(2 * inner.translation().norm(), made.translation().norm());
  if (made.matrix().allFinite() && !rounding.covered(made.translation().norm()))
    throw std::invalid_argument(who + " is put there by ways that cancel, and double loses up to " +
                                std::to_string(1e3 * rounding.lost) + " mm of them");
  return made;
}

namespace {

position at(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

/// Is a follower's value a small number without any rounding?
bool exact(const mimic& by, double leader) {
  const double product = by.multiplier * leader, sum = product + by.offset;
  return std::fma(by.multiplier, leader, -product) == 0 && sum - product == by.offset && sum - by.offset == product &&
         std::abs(product) + std::abs(by.offset) <= 0x1p22;
}

}  // namespace

kinematic_tree::kinematic_tree(std::vector<std::string> links, std::vector<joint> joints)
    : links_(std::move(links)), joints_(std::move(joints)) {
  for (std::size_t i = 0; i < links_.size(); ++i)
    if (!link_at_.emplace(links_[i], i).second) throw std::invalid_argument("two links are named \"" + links_[i] + '"');
  for (std::size_t j = 0; j < joints_.size(); ++j)
    if (!joint_at_.emplace(joints_[j].name, j).second)
      throw std::invalid_argument("two joints are named \"" + joints_[j].name + '"');
  above_.assign(links_.size(), none);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    check(joints_[j]);
    const std::size_t child = link(joints_[j].child);
    link(joints_[j].parent);
    if (above_[child] != none)
      throw std::invalid_argument("link \"" + links_[child] + "\" has two joints above it, \"" +
                                  joints_[above_[child]].name + "\" and \"" + joints_[j].name + "\"");
    above_[child] = j;
    if (joints_[j].movable()) movable_.push_back(j);
  }
  order_links();
  order_values();
}

std::size_t kinematic_tree::link(const std::string& name) const {
  const auto at = link_at_.find(name);
  if (at == link_at_.end()) throw std::invalid_argument("the robot has no link \"" + name + '"');
  return at->second;
}

std::vector<double> kinematic_tree::rest() const {
  std::vector<double> q;
  for (const std::size_t j : movable_) q.push_back(std::clamp(0.0, joints_[j].lower, joints_[j].upper));
  return q;
}

std::vector<double> kinematic_tree::configuration(const std::map<std::string, double>& values,
                                                  joint_options options) const {
  std::vector<double> q = rest();
  for (const auto& [name, value] : values) {
    const std::size_t i = value_of(name);
    q[i] = value;
    check_value(joints_[movable_[i]], value, options);
  }
  return q;
}

std::vector<Eigen::Isometry3d> kinematic_tree::link_poses(std::span<const double> q, joint_options options) const {
  if (q.size() != size())
    throw std::invalid_argument("the robot has " + std::to_string(size()) + " movable joints, here are " +
                                std::to_string(q.size()) + " values");

  std::vector<double> value(joints_.size(), 0.0);
  for (std::size_t i = 0; i < q.size(); ++i) {
    check_value(joints_[movable_[i]], q[i], options);
    value[movable_[i]] = q[i];
  }

  std::vector<double> terms(joints_.size(), 0.0),
      off(joints_.size(), 0.0);  // of followers: magnitudes, and what is lost
  for (const auto& [j, leader] : followers_) {
    const mimic& by = *joints_[j].follows;
    const double product = by.multiplier * value[leader];
    value[j] = product + by.offset;
    if (by.multiplier != 1 || by.offset != 0) terms[j] = std::abs(product) + std::abs(by.offset);
    off[j] = std::abs(by.multiplier) * off[leader] + (exact(by, value[leader]) ? 0 : chain_rounding::of_sum(terms[j]));
    if (!std::isfinite(value[j]))
      throw std::invalid_argument("joint \"" + joints_[j].name + "\" follows \"" + joints_[leader].name +
                                  "\" to a value that is not finite");
  }

  std::vector<Eigen::Isometry3d> poses(links_.size(), Eigen::Isometry3d::Identity());
  std::vector<chain_rounding> rounding(links_.size());
  for (const auto& [j, parent, child] : steps_) {
    const joint& by = joints_[j];
    poses[child] = poses[parent] * by.origin;
    rounding[child] = rounding[parent];
    rounding[child].step(at(poses[parent].translation()), at(by.origin.translation()), at(poses[child].translation()),
                         by.origin.translation().norm());
    if (by.turns() || by.origin.linear() != Eigen::Matrix3d::Identity()) rounding[child].turned();
    if (by.turns() && (!chain_rounding::turns(value[j], terms[j], terms[j] != 0) || off[j] > 1e-9))
      throw std::invalid_argument("joint \"" + by.name + "\" turns its link by more than " +
                                  (terms[j] != 0 ? "2^22 rad, times a factor or plus an offset" : "2^30 rad"));
    if (by.kind == joint_kind::prismatic) {
      rounding[child].lost += off[j];
      const position before = at(poses[child].translation());
      poses[child].translate(value[j] * by.axis);
      rounding[child].step(before, at(value[j] * by.axis), at(poses[child].translation()), std::abs(value[j]));
    }
    if (by.turns()) poses[child].rotate(Eigen::AngleAxisd(value[j], by.axis));

    if (!poses[child].matrix().allFinite())
      throw std::invalid_argument("joint \"" + by.name + "\" puts its link beyond what a number can hold");
    if (!rounding[child].covered(poses[child].translation().norm()))
      throw std::invalid_argument("joint \"" + by.name +
                                  "\" puts its link there by ways that cancel, and double loses up to " +
                                  std::to_string(1e3 * rounding[child].lost) + " mm of them");
  }
  return poses;
}

void kinematic_tree::check(joint& j) const {
  const std::string who = "joint \"" + j.name + "\" ";
  const Eigen::Matrix3d r = j.origin.linear();
  if (!j.origin.matrix().allFinite() || !(r * r.transpose()).isIdentity(1e-9) || r.determinant() < 0)
    throw std::invalid_argument(who + "has an origin that is not a rigid transform");
  if (j.kind == joint_kind::fixed) {
    j.follows.reset();
    return;
  }
  const double length = j.axis.norm();
  if (!(length > 1e-9) || !std::isfinite(length)) throw std::invalid_argument(who + "has an axis without direction");
  j.axis /= length;
  if (!(j.lower <= j.upper)) throw std::invalid_argument(who + "has a lower limit above its upper limit");
  if (j.follows && !(std::isfinite(j.follows->multiplier) && std::isfinite(j.follows->offset)))
    throw std::invalid_argument(who + "follows another by a factor that is not finite");
}

void kinematic_tree::order_links() {
  std::vector<std::vector<std::size_t>> below(links_.size());
  std::vector<std::size_t> pending;
  for (std::size_t i = 0; i < links_.size(); ++i)
    if (above_[i] == none)
      pending.push_back(i);
    else
      below[link(joints_[above_[i]].parent)].push_back(i);
  if (pending.size() != 1)
    throw std::invalid_argument("the joints make " + std::to_string(pending.size()) + " trees, not one");
  base_ = pending[0];
  while (!pending.empty()) {
    const std::size_t parent = pending.back();
    pending.pop_back();
    for (const std::size_t child : below[parent]) {
      steps_.push_back({above_[child], parent, child});
      pending.push_back(child);
    }
  }
  if (steps_.size() + 1 != links_.size())
    throw std::invalid_argument("some joints make a ring, apart from the base link");
}

void kinematic_tree::order_values() {
  drives_.resize(joints_.size());
  for (std::size_t i = 0; i < movable_.size(); ++i) drives_[movable_[i]] = {i, 1, 0, 0};
  std::vector<bool> done(joints_.size()), entered(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    std::vector<std::size_t> chain;
    for (std::size_t at = j; joints_[at].follows && !done[at];
         at = find(joints_[at].follows->joint, joints_[at].name)) {
      if (entered[at]) throw std::invalid_argument("joint \"" + joints_[at].name + "\" follows itself");
      entered[at] = true;
      chain.push_back(at);
    }
    for (; !chain.empty(); chain.pop_back()) {
      const std::size_t leader = find(joints_[chain.back()].follows->joint, "");
      if (joints_[leader].kind == joint_kind::fixed)
        throw std::invalid_argument("joint \"" + joints_[chain.back()].name + "\" follows the fixed joint \"" +
                                    joints_[leader].name + "\"");
      followers_.push_back({chain.back(), leader});
      follow(chain.back(), leader);
      done[chain.back()] = true;
    }
  }
}

void kinematic_tree::follow(std::size_t j, std::size_t leader) {
  const mimic& by = *joints_[j].follows;
  const joint_drive& above = drives_[leader];
  drives_[j] = {above.value, by.multiplier * above.factor, by.multiplier * above.offset + by.offset,
                std::abs(by.multiplier) * above.offsets + std::abs(by.offset)};
  if (!std::isfinite(drives_[j].factor) || !std::isfinite(drives_[j].offsets))
    throw std::invalid_argument("joint \"" + joints_[j].name + "\" follows \"" + joints_[movable_[above.value]].name +
                                "\" by a factor that is not finite");
}

std::size_t kinematic_tree::find(const std::string& name, const std::string& for_whom) const {
  if (const auto at = joint_at_.find(name); at != joint_at_.end()) return at->second;
  std::string steps;  // of a joint of several values
  for (auto at = joint_at_.lower_bound(name + "/"); at != joint_at_.end() && at->first.starts_with(name + "/"); ++at)
    steps += (steps.empty() ? "\"" : ", \"") + at->first + '"';
  if (!steps.empty() && for_whom.empty())
    throw std::invalid_argument("joint \"" + name + "\" has several values: " + steps);
  throw std::invalid_argument(for_whom.empty()
                                  ? "the robot has no joint \"" + name + "\""
                                  : "joint \"" + for_whom + "\" follows \"" + name + "\", which does not exist");
}

std::size_t kinematic_tree::value_of(const std::string& name) const {
  const std::size_t at = find(name, "");
  const joint& j = joints_[at];
  if (j.kind == joint_kind::fixed) throw std::invalid_argument("joint \"" + name + "\" is fixed and takes no value");
  if (j.follows)
    throw std::invalid_argument("joint \"" + name + "\" follows \"" + j.follows->joint + "\" and takes no value");
  return std::size_t(std::lower_bound(movable_.begin(), movable_.end(), at) - movable_.begin());
}

void kinematic_tree::check_value(const joint& j, double value, joint_options options) {
  if (!std::isfinite(value)) throw std::invalid_argument("joint \"" + j.name + "\" has a value that is not finite");
  if (!options.ignore_limits && !(value >= j.lower && value <= j.upper))
    throw std::invalid_argument("joint \"" + j.name + "\" at " + std::to_string(value) + " is outside its limits " +
                                std::to_string(j.lower) + " to " + std::to_string(j.upper));
}

}  // namespace clearance::io
