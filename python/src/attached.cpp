// SPDX-License-Identifier: BSD-3-Clause
// A robot that holds something: what is attached is a link more, with a fixed joint, so that joints, many
// configurations and gradients need no rule of their own.
#include "robot.hpp"

#include "arrays.hpp"

#include <clearance/io/sentence.hpp>

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

using namespace clearance;

namespace {

/// A robot of these bodies, whose trees are built again, described so.
std::shared_ptr<robot_model> rebuilt(const robot_model& robot, std::vector<io::body> bodies, io::kinematic_tree tree,
                                     std::vector<io::robot_part> parts) {
  const auto made = std::make_shared<robot_model>();
  const nb::gil_scoped_release others;
  made->name = robot.name;
  made->notes = robot.notes;
  made->spheres = robot.spheres;
  made->bodies = std::move(bodies);
  made->description.emplace(robot.name, std::move(tree), std::move(parts), robot.notes);
  build(*made);
  return made;
}

}  // namespace

std::shared_ptr<robot_model> attached_robot(const nb::object& self, const std::string& link, const nb::object& object,
                                            nb::handle pose) {
  const auto& robot = nb::cast<const robot_model&>(self);
  const robot_model* held = nullptr;
  if (!nb::try_cast(object, held) || !held)
    throw nb::type_error("attach: object is a Robot, such as Robot.from_meshes({\"box\": \"box.stl\"}) makes one");
  if (held->spheres != robot.spheres)
    throw std::invalid_argument(std::string("clearance: the object has ") + (held->spheres ? "spheres" : "triangles") +
                                ", and the robot has " + (robot.spheres ? "spheres" : "triangles") +
                                "; make both by the same model=");
  if (held->description && joints_of(*held).size() != 0)
    throw std::invalid_argument("clearance: the object has joints of its own, and what is held moves as one");
  const io::kinematic_tree& tree = joints_of(robot);
  named([&] { return tree.link(link); });
  const Eigen::Isometry3d at = pose_of(pose, "pose");
  const auto its = robot_at(*held, nb::none(), nb::none(), {.rest = true}).poses;
  std::vector<std::string> links = tree.links();
  std::vector<io::joint> joints = tree.joints();
  std::vector<io::body> bodies = robot.bodies;
  std::vector<io::robot_part> parts = robot.described().parts();
  for (std::size_t k = 0; k < held->parts(); ++k) {
    const std::string& name = held->bodies[k].name;
    if (std::ranges::find(links, name) != links.end())
      throw std::invalid_argument("clearance: the object's part " + io::quoted(name) +
                                  " has the name of one of the robot's links");
    parts.push_back({.name = name, .mesh = {}, .link = links.size()});
    links.push_back(name);
    joints.push_back({.name = "attached " + name, .parent = link, .child = name, .origin = at * its[k], .follows = {}});
    bodies.push_back(held->bodies[k]);
  }
  const auto made = named([&] {
    return rebuilt(robot, std::move(bodies), io::kinematic_tree(std::move(links), std::move(joints)), std::move(parts));
  });
  made->held = robot.held;
  for (const std::string& name : *held->names) made->held.push_back(name);
  made->maker = "attach";
  made->recipe = nb::make_tuple(self, link, object, rows_of({at}, {}));
  return made;
}

std::shared_ptr<robot_model> released_robot(const nb::object& self, const std::vector<std::string>& names) {
  const auto& robot = nb::cast<const robot_model&>(self);
  for (const std::string& name : names)
    if (std::ranges::find(robot.held, name) == robot.held.end())
      throw std::invalid_argument("clearance: nothing of the name " + io::quoted(name) + " is attached" +
                                  (robot.held.empty() ? "" : ", only " + listed(robot.held)));
  const std::vector<std::string>& gone = names.empty() ? robot.held : names;
  const auto stays = [&](const std::string& name) { return std::ranges::find(gone, name) == gone.end(); };
  const io::kinematic_tree& tree = joints_of(robot);
  std::vector<std::string> links;
  std::vector<io::joint> joints;
  for (const std::string& name : tree.links())
    if (stays(name)) links.push_back(name);
  for (const io::joint& joint : tree.joints()) {
    if (!stays(joint.child)) continue;
    if (!stays(joint.parent))
      throw std::invalid_argument("clearance: " + io::quoted(joint.child) + " is attached to " +
                                  io::quoted(joint.parent) + ", so it is released first");
    joints.push_back(joint);
  }
  io::kinematic_tree rest(links, std::move(joints));
  std::vector<io::body> bodies;
  std::vector<io::robot_part> parts;
  for (std::size_t k = 0; k < robot.parts(); ++k) {
    if (!stays(robot.bodies[k].name)) continue;
    bodies.push_back(robot.bodies[k]);
    parts.push_back(robot.described().parts()[k]);
    parts.back().link = rest.link(parts.back().name);
  }
  const auto made = rebuilt(robot, std::move(bodies), std::move(rest), std::move(parts));
  for (const std::string& name : robot.held)
    if (stays(name)) made->held.push_back(name);
  made->maker = "release";
  made->recipe = nb::make_tuple(self, gone);
  return made;
}
