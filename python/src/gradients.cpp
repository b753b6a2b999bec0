// SPDX-License-Identifier: BSD-3-Clause
#include "gradients.hpp"

#include "arrays.hpp"
#include "robot.hpp"
#include "values.hpp"

#include <clearance/io/jacobian.hpp>

#include <nanobind/stl/shared_ptr.h>

using namespace clearance;

namespace {

/// One row for each configuration: NaN where a distance has no gradient.
nb::object joint_gradients(const std::shared_ptr<robot_model>& robot, nb::handle joints, nb::handle result,
                           nb::handle base, bool ignore_limits, bool rest) {
  const io::robot& described = robot->described();
  const asked_about* about = nullptr;
  std::span<const min_distance_result> witnesses;
  answered<min_distances_result>* several = nullptr;
  answered<min_distance_result>* one = nullptr;
  if (nb::try_cast(result, several) && several)
    witnesses = several->value.of, about = &several->about;
  else if (nb::try_cast(result, one) && one)
    witnesses = {&one->value, 1}, about = &one->about;
  else
    throw std::invalid_argument("clearance: result is a MinDistanceResult or a MinDistancesResult, not " +
                                shape_and_type(result));
  if (about->names != robot->names) throw std::invalid_argument("clearance: result is of another robot than robot");
  const joint_rows rows = joints_given(*robot, joints, {ignore_limits, rest});
  if (rows.size() != witnesses.size())
    throw std::invalid_argument("clearance: result is about " + std::to_string(witnesses.size()) +
                                " configurations, and joints has " + std::to_string(rows.size()));
  const Eigen::Isometry3d to = pose_of(base, "base");
  const std::vector<Eigen::Isometry3d> poses = placed_parts(*robot, rows, to, ignore_limits);
  if (about->poses != digest_of(poses))
    throw std::invalid_argument("clearance: result is of other joints, or of another base, than are given here");
  const std::vector<std::size_t> columns = own_columns(*robot, *rows.tree);
  const std::size_t dof = columns.size();
  std::vector<double> all(witnesses.size() * dof, double(not_a_number));
  for (std::size_t c = 0; c < witnesses.size(); ++c) {
    const pose_gradient g = gradient(witnesses[c], witnesses[c].nearest);
    if (!g) continue;
    const auto by =
        io::joint_gradient(*rows.tree, rows.links(c, to, ignore_limits), described.parts()[witnesses[c].part].link, g);
    for (std::size_t j = 0; by && j < dof; ++j) all[c * dof + j] = (*by)[Eigen::Index(columns[j])];
  }
  std::vector<std::size_t> shape = rows.shape;
  shape.push_back(dof);
  return own_array(std::move(all), shape);
}

}  // namespace

void bind_gradients(nb::module_& m) {
  m.def("joint_gradients", &joint_gradients, nb::arg("robot"), nb::arg("joints").none(), nb::arg("result"),
        nb::arg("base").none() = nb::none(), nb::arg("ignore_limits") = false, nb::arg("rest") = false,
        "How each least distance changes with the joints, (..., joints): metres per radian or metre, from its witness. "
        "joints and base are those that were asked; ValueError if not, or if result is of another robot. A row is NaN "
        "where there is no gradient: no witness, distance 0, or "
        "the centre of a sphere.");
}
