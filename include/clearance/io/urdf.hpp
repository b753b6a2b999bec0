// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/error.hpp>
#include <clearance/io/kinematics.hpp>
#include <clearance/io/xml_scan.hpp>

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace clearance::io {

/// What urdfdom made of a file, its links in the file's order, and its joints as a tree.
struct urdf_file {
  std::string name;
  std::vector<std::shared_ptr<urdf::Link>> links;
  kinematic_tree tree;
};

/// Keeps what urdfdom would print on stderr. The printer is one for the whole program: one at a time.
class urdf_messages final : public console_bridge::OutputHandler {
 public:
  urdf_messages() : before_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
  ~urdf_messages() override { console_bridge::useOutputHandler(before_); }
  urdf_messages(const urdf_messages&) = delete;
  urdf_messages& operator=(const urdf_messages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors += (errors.empty() ? "" : "; ") + text;
  }
  std::string errors;

 private:
  console_bridge::OutputHandler* before_;
};

/// A URDF pose in double. False if it is not finite; URDF cannot say more that is not rigid.
inline bool rigid_pose(const urdf::Pose& from, Eigen::Isometry3d& to) {
  const Eigen::Quaterniond q(from.rotation.w, from.rotation.x, from.rotation.y, from.rotation.z);
  to = Eigen::Isometry3d::Identity();
  to.linear() = q.normalized().toRotationMatrix();
  to.translation() << from.position.x, from.position.y, from.position.z;
  return to.matrix().allFinite();
}

/// Reads a URDF file through urdfdom, keeping the order of its links and joints, which urdfdom sorts by name. Throws
/// std::runtime_error with the file's name if it is damaged, still has xacro in it, or has floating or planar joints.
inline urdf_file read_urdf(const std::string& file) {
  const std::string text = read_bytes(file);
  std::vector<std::string> link_order, joint_order;
  bool is_robot = false;
  scan_xml(text, file, [&](const xml_tag& tag) {
    if (tag.depth == 0) is_robot = tag.element == "robot";
    if (tag.element.starts_with("xacro:")) refuse(file, "has xacro in it: expand it with xacro first", tag.line);
    if (tag.depth != 1) return;
    if (tag.element == "link") link_order.emplace_back(tag.attribute("name"));
    if (tag.element == "joint") joint_order.emplace_back(tag.attribute("name"));
  });
  if (!is_robot) refuse(file, "is not a URDF file: it has no element robot");

  static std::mutex one_at_a_time;
  urdf::ModelInterfaceSharedPtr model;
  std::string errors;
  try {
    const std::lock_guard lock(one_at_a_time);
    urdf_messages messages;
    model = urdf::parseURDF(text);
    errors = messages.errors;
  } catch (const std::exception& error) {
    model.reset();
    errors = error.what();
  }
  std::replace(errors.begin(), errors.end(), '\n', ' ');
  if (!model) refuse(file, "is no valid URDF: " + (errors.empty() ? "urdfdom does not say why" : errors));
  // Links know their children and, in a ring, so keep one another alive: the tree here needs only the joints.
  for (auto& [name, link] : model->links_) link->child_links.clear();

  urdf_file made;
  made.name = model->getName();
  std::vector<std::string> link_names;
  for (const auto& [name, link] : model->links_)
    link_order.push_back(name);  // whatever the scan did not see, at the end
  for (std::set<std::string> seen; const auto& name : link_order)
    if (const auto at = model->links_.find(name); at != model->links_.end() && seen.insert(name).second) {
      link_names.push_back(name);
      made.links.push_back(at->second);
    }
  std::vector<joint> joints;
  for (const auto& [name, unused] : model->joints_) joint_order.push_back(name);
  for (std::set<std::string> seen; const auto& name : joint_order) {
    const auto at = model->joints_.find(name);
    if (at == model->joints_.end() || !seen.insert(name).second) continue;
    const urdf::Joint& from = *at->second;
    joint to{name, joint_kind::fixed, from.parent_link_name, from.child_link_name, {}, {}, {}, {}, {}};
    if (!rigid_pose(from.parent_to_joint_origin_transform, to.origin))
      refuse(file, "joint \"" + name + "\" has an origin that is not finite");
    to.axis << from.axis.x, from.axis.y, from.axis.z;
    to.upper = std::numeric_limits<double>::infinity();
    to.lower = -to.upper;
    switch (from.type) {
      case urdf::Joint::FIXED:
        break;
      case urdf::Joint::CONTINUOUS:
        to.kind = joint_kind::continuous;
        break;
      case urdf::Joint::REVOLUTE:
        to.kind = joint_kind::revolute;
        break;
      case urdf::Joint::PRISMATIC:
        to.kind = joint_kind::prismatic;
        break;
      case urdf::Joint::FLOATING:
        refuse(file, "joint \"" + name + "\" is floating, which is not supported: give the base pose instead");
      case urdf::Joint::PLANAR:
        refuse(file, "joint \"" + name + "\" is planar, which is not supported");
      default:
        refuse(file, "joint \"" + name + "\" has an unknown type");
    }
    if (from.limits && (to.kind == joint_kind::revolute || to.kind == joint_kind::prismatic)) {
      to.lower = from.limits->lower;
      to.upper = from.limits->upper;
    }
    if (from.mimic) to.follows = mimic{from.mimic->joint_name, from.mimic->multiplier, from.mimic->offset};
    joints.push_back(std::move(to));
  }
  try {
    made.tree = kinematic_tree(std::move(link_names), std::move(joints));
  } catch (const std::invalid_argument& error) {
    refuse(file, error.what());
  }
  return made;
}

}  // namespace clearance::io
