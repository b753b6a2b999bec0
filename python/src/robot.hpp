// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot in Python: bodies and their trees, and what its description says about how they move.

#include "asker.hpp"

#include <clearance/io/digest.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/robot_bodies.hpp>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <map>
#include <mutex>
#include <optional>

namespace nb = nanobind;

using matrix_array = nb::ndarray<const double, nb::device::cpu, nb::c_contig>;

/// What Python's Robot holds. It never changes, except for what devices keep of it.
struct robot_model {
  std::string name;
  std::shared_ptr<const std::vector<std::string>> names;  ///< Of the parts.
  std::shared_ptr<const robot_trees<>> trees;
  std::vector<clearance::io::body> bodies;
  std::optional<clearance::io::robot> description;  ///< Of a URDF file.
  std::vector<std::string> notes;
  std::vector<std::string> held;  ///< The parts that are attached.
  bool spheres = true;
  const char* maker = nullptr;  ///< What makes it again, and
  nb::object recipe;            ///< its arguments, for pickle.

  std::mutex devices;
  std::map<int, std::shared_ptr<void>> on_device;  ///< Its trees on each device that was asked.

  mutable std::mutex freeing;
  mutable std::map<std::vector<std::string>, std::shared_ptr<const clearance::io::kinematic_tree>> freed;

  std::size_t parts() const { return names->size(); }
  /// Throws std::invalid_argument for a robot without joints.
  const clearance::io::robot& described() const;
};

/// Builds the trees of its bodies, and takes their names. Without the interpreter.
void build(robot_model& made);

/// A description itself, and no file's name?
bool is_text(const std::string& given);

/// The tree of a robot with joints. Throws std::invalid_argument for one without.
inline const clearance::io::kinematic_tree& joints_of(const robot_model& robot) {
  return robot.described().kinematics();
}

/// What `ask` returns; of what it refuses, `which` says where it is.
template <class Ask>
auto named(Ask ask, const std::string& which = {}) {
  try {
    return ask();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("clearance: " + which + error.what());
  }
}

/// "a", "b" and 3 more
std::string listed(const std::vector<std::string>& names);

/// Poses as an array of shape (..., 4, 4).
nb::object rows_of(const std::vector<Eigen::Isometry3d>& poses, std::vector<std::size_t> shape);

/// One pose, or several, from arrays of shape (..., 4, 4). Throws std::invalid_argument, which names the argument.
Eigen::Isometry3d pose_of(nb::handle given, const char* argument);
/// `shape`: of the axes before a pose's.
std::vector<Eigen::Isometry3d> poses_of(nb::handle given, const char* argument,
                                        std::vector<std::size_t>* shape = nullptr);

/// How joint values are read.
struct joint_reading {
  bool ignore_limits = false;
  bool rest = false;  ///< Joints that nothing is said of are at rest; otherwise they are refused.
};

/// Joint values, one configuration after another, and the shape before the last axis. They are values of `tree`: the
/// robot's own, or, where joints that follow others were given values of their own, one in which they are free.
struct joint_rows {
  std::vector<double> values;
  std::vector<std::size_t> shape;
  std::shared_ptr<const clearance::io::kinematic_tree> tree;

  std::size_t size() const;  ///< How many configurations.
  /// The poses of all links in one configuration, with the base at `base`. Throws std::invalid_argument, which says of
  /// several which one it is.
  std::vector<Eigen::Isometry3d> links(std::size_t configuration, const Eigen::Isometry3d& base,
                                       bool ignore_limits) const;
};
/// From an array of shape (..., joints), from {name: value}, or from None.
joint_rows joints_given(const robot_model& robot, nb::handle given, joint_reading how);

/// The poses of all parts in all configurations.
std::vector<Eigen::Isometry3d> placed_parts(const robot_model& robot, const joint_rows& joints,
                                            const Eigen::Isometry3d& base, bool ignore_limits);

/// Where all parts are: by joints, or, of a robot without them, all at the base, if that is what is meant.
struct placed_robot {
  std::vector<Eigen::Isometry3d> poses;
  std::vector<std::size_t> shape;  ///< Of the configurations.
};
placed_robot robot_at(const robot_model& robot, nb::handle joints, nb::handle base, joint_reading how);
/// The same, or by poses of the parts, if they are given.
placed_robot robot_placed(const robot_model& robot, nb::handle joints, nb::handle poses, nb::handle base,
                          joint_reading how);

/// A fingerprint of poses, to the bit.
clearance::io::digest digest_of(std::span<const Eigen::Isometry3d> poses);

/// Columns that stand for `from`'s values, as columns of the robot's own: those of joints that were freed are left out.
std::vector<std::size_t> own_columns(const robot_model& robot, const clearance::io::kinematic_tree& from);

/// The robot with an object's parts, each on a link of its own that a fixed joint holds. Throws std::invalid_argument.
std::shared_ptr<robot_model> attached_robot(const nb::object& self, const std::string& link, const nb::object& object,
                                            nb::handle pose);
/// The robot without some of what is attached; without names, without all of it. Throws std::invalid_argument for a
/// name of nothing that is attached, and for one that holds something else.
std::shared_ptr<robot_model> released_robot(const nb::object& self, const std::vector<std::string>& names);

void bind_robot(nb::module_& m);
