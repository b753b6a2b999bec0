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
                           nb::handle base, bool ignore_limits) {
  const io::robot& described = robot->described();
  std::span<const min_distance_result> witnesses;
  answered<min_distances_result>* several = nullptr;
  answered<min_distance_result>* one = nullptr;
  if (nb::try_cast(result, several) && several)
    witnesses = several->value.of;
  else if (nb::try_cast(result, one) && one)
    witnesses = {&one->value, 1};
  else
    throw std::invalid_argument("clearance: result is a MinDistanceResult or a MinDistancesResult, not " +
                                shape_and_type(result));
  const joint_rows rows = joints_given(*robot, joints, ignore_limits);
  const std::size_t dof = described.kinematics().size();
  if (rows.values.size() != witnesses.size() * dof)
    throw std::invalid_argument("clearance: result is about " + std::to_string(witnesses.size()) +
                                " configurations, and joints has " + std::to_string(rows.values.size() / dof));
  const Eigen::Isometry3d to = pose_of(base, "base");
  std::vector<double> all(rows.values.size(), double(not_a_number));
  for (std::size_t c = 0; c < witnesses.size(); ++c) {
    const pose_gradient g = gradient(witnesses[c], witnesses[c].nearest);
    if (!g) continue;
    const auto by = io::joint_gradient(described, std::span(rows.values).subspan(c * dof, dof), witnesses[c].part, g,
                                       {ignore_limits}, to);
    if (by) std::copy(by->data(), by->data() + by->size(), all.begin() + std::ptrdiff_t(c * dof));
  }
  std::vector<std::size_t> shape = rows.shape;
  shape.push_back(dof);
  return own_array(std::move(all), shape);
}

}  // namespace

void bind_gradients(nb::module_& m) {
  m.def(
      "joint_gradients", &joint_gradients, nb::arg("robot"), nb::arg("joints"), nb::arg("result"),
      nb::arg("base").none() = nb::none(), nb::arg("ignore_limits") = false,
      "How each least distance changes with the joints, (..., joints): metres per radian or metre, from its witness. "
      "joints and base are those that were asked. A row is NaN where there is no gradient: no witness, distance 0, or "
      "the centre of a sphere.");
}
