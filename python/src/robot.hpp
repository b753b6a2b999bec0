// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot in Python: bodies and their trees, and what its description says about how they move.

#include "asker.hpp"

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
  bool spheres = true, has_fields = false;
  const char* maker = nullptr;  ///< What makes it again, and
  nb::object recipe;            ///< its arguments, for pickle.

  std::mutex devices;
  std::map<int, std::shared_ptr<void>> on_device;  ///< Its trees on each device that was asked.

  std::size_t parts() const { return names->size(); }
  /// Throws std::invalid_argument for a robot without joints.
  const clearance::io::robot& described() const;
};

/// One pose, or several, from arrays of shape (..., 4, 4). Throws std::invalid_argument, which names the argument.
Eigen::Isometry3d pose_of(nb::handle given, const char* argument);
std::vector<Eigen::Isometry3d> poses_of(nb::handle given, const char* argument);

/// Joint values, one configuration after another, and the shape before the last axis.
struct joint_rows {
  std::vector<double> values;
  std::vector<std::size_t> shape;
};
/// From an array of shape (..., joints), from {name: value}, or, of None, the joints at rest.
joint_rows joints_given(const robot_model& robot, nb::handle given, bool ignore_limits);

/// The poses of all parts for joint values of shape (..., joints), or for {name: value}.
std::vector<Eigen::Isometry3d> placed_parts(const robot_model& robot, nb::handle joints, const Eigen::Isometry3d& base,
                                            bool ignore_limits);

void bind_robot(nb::module_& m);
