// SPDX-License-Identifier: BSD-3-Clause
#include "gradients.hpp"

#include "arrays.hpp"
#include "robot.hpp"
#include "values.hpp"

#include <clearance/io/jacobian.hpp>

#include <nanobind/stl/shared_ptr.h>

using namespace clearance;

namespace {

/// Answers, each with a row of its own: so many of each configuration.
template <class Found>
struct found_rows {
  std::span<const Found> all;
  const asked_about* about;
  std::size_t each;   // of a configuration
  bool several_each;  // they have an axis of their own
};

/// The rows of all answers: NaN where a distance has no gradient.
template <class Found>
nb::object rows_of(const robot_model& robot, const found_rows<Found>& found, nb::handle joints, nb::handle base,
                   joint_reading how) {
  if (found.about->names != robot.names)
    throw std::invalid_argument("clearance: result is of another robot than robot");
  const joint_rows rows = joints_given(robot, joints, how);
  if (rows.size() * found.each != found.all.size())
    throw std::invalid_argument("clearance: result is about " +
                                std::to_string(found.each ? found.all.size() / found.each : 1) +
                                " configurations, and joints has " + std::to_string(rows.size()));
  const Eigen::Isometry3d to = pose_of(base, "base");
  if (found.about->poses != digest_of(placed_parts(robot, rows, to, how.ignore_limits)))
    throw std::invalid_argument("clearance: result is of other joints, or of another base, than are given here");
  const auto& parts = robot.described().parts();
  const std::vector<std::size_t> columns = own_columns(robot, *rows.tree);
  const std::size_t dof = columns.size();
  std::vector<double> all(found.all.size() * dof, double(not_a_number));
  {
    const nb::gil_scoped_release others;
    for (std::size_t c = 0; c < rows.size(); ++c) {
      const std::vector<Eigen::Isometry3d> links = rows.links(c, to, how.ignore_limits);
      for (std::size_t k = c * found.each; k < (c + 1) * found.each; ++k) {
        const auto by = io::joint_gradient_of(*rows.tree, links, found.all[k],
                                              [&](std::uint32_t part) { return parts[part].link; });
        for (std::size_t j = 0; by && j < dof; ++j) all[k * dof + j] = (*by)[Eigen::Index(columns[j])];
      }
    }
  }
  std::vector<std::size_t> shape = rows.shape;
  if (found.several_each) shape.push_back(found.each);
  shape.push_back(dof);
  return own_array(std::move(all), shape);
}

nb::object joint_gradients(const std::shared_ptr<robot_model>& robot, nb::handle joints, nb::handle result,
                           nb::handle base, bool ignore_limits, bool rest) {
  answered<min_distance_result>* one = nullptr;
  answered<min_distances_result>* several = nullptr;
  answered<min_distances_per_part_result>* per_part = nullptr;
  answered<self_distance_result>* itself = nullptr;
  const auto rows = [&]<class Found>(std::span<const Found> all, const asked_about& about, std::size_t each,
                                     bool axis) {
    return rows_of(*robot, found_rows<Found>{all, &about, each, axis}, joints, base, {ignore_limits, rest});
  };
  if (nb::try_cast(result, one) && one)
    return rows(std::span<const min_distance_result>(&one->value, 1), one->about, 1, false);
  if (nb::try_cast(result, several) && several)
    return rows(std::span<const min_distance_result>(several->value.of), several->about, 1, false);
  if (nb::try_cast(result, per_part) && per_part)
    return rows(std::span<const min_distance_result>(per_part->value.all), per_part->about, robot->parts(), true);
  if (nb::try_cast(result, itself) && itself)
    return rows(std::span<const pair_clearance>(itself->value.pairs), itself->about, itself->value.pairs.size(), true);
  throw std::invalid_argument(
      "clearance: result is a MinDistanceResult, a MinDistancesResult, a MinDistancesPerPartResult or a "
      "SelfDistanceResult, not " +
      shape_and_type(result));
}

}  // namespace

void bind_gradients(nb::module_& m) {
  m.def("joint_gradients", &joint_gradients, nb::arg("robot"), nb::arg("joints").none(), nb::arg("result"),
        nb::arg("base").none() = nb::none(), nb::arg("ignore_limits") = false, nb::arg("rest") = false,
        "How each least distance changes with the joints, metres per radian or metre: (..., joints) of MinDistance and "
        "MinDistances, (..., parts, joints) of MinDistancesPerPart, (pairs, joints) of SelfQuery. joints and base are "
        "those that were asked; ValueError if not, or if result is of another robot. A row is NaN where there is no "
        "gradient: no witness, distance 0, or the centre of a sphere.");
}
