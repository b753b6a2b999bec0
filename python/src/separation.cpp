// SPDX-License-Identifier: BSD-3-Clause
// How fast a gap closes, and how wide a standard wants it to be.
#include "separation.hpp"

#include "arrays.hpp"
#include "values.hpp"

#include <clearance/separation.hpp>

#include <nanobind/stl/optional.h>

using namespace clearance;

namespace {

Eigen::Vector3d vector_of(nb::handle given, const char* argument) {
  const auto v = three_of(given, argument);
  return {v[0], v[1], v[2]};
}

std::optional<double> speed_of(nb::handle result, nb::handle velocity, nb::handle turning, nb::handle about,
                               nb::handle point_velocity) {
  const auto ask = [&](const auto& witness) {
    return approach_speed(witness, vector_of(velocity, "velocity"), vector_of(turning, "turning"),
                          vector_of(about, "about"), vector_of(point_velocity, "point_velocity"));
  };
  answered<min_distance_result>* least = nullptr;
  answered<part_witness>* of_part = nullptr;
  if (nb::try_cast(result, least) && least) return ask(least->value);
  if (nb::try_cast(result, of_part) && of_part) return ask(of_part->value);
  throw nb::type_error(
      ("approach_speed: result is a MinDistanceResult or a PartWitness, not " + shape_and_type(result)).c_str());
}

}  // namespace

void bind_separation(nb::module_& m) {
  const nb::object zero = nb::make_tuple(0.0, 0.0, 0.0);
  m.def(
      "approach_speed", &speed_of, nb::arg("result"), nb::arg("velocity"), nb::arg("turning") = zero,
      nb::arg("about") = zero, nb::arg("point_velocity") = zero,
      "How fast the least distance shrinks, m/s; negative if the pair moves apart, None where it has no gradient. The "
      "result's part moves with velocity (m/s) at about and turns by turning (rad/s); point_velocity is the point's. "
      "All in world axes, such as Robot.jacobian(q, part, about) times joint speeds. Other pairs may close faster.");
  m.def(
      "protective_separation",
      [](double human_speed, double robot_speed, double reaction_time, double stopping_time, double stopping_distance,
         double intrusion, double human_uncertainty, double robot_uncertainty) {
        return protective_separation({.human_speed = human_speed,
                                      .robot_speed = robot_speed,
                                      .reaction_time = reaction_time,
                                      .stopping_time = stopping_time,
                                      .stopping_distance = stopping_distance,
                                      .intrusion = intrusion,
                                      .human_uncertainty = human_uncertainty,
                                      .robot_uncertainty = robot_uncertainty});
      },
      nb::kw_only(), nb::arg("human_speed"), nb::arg("robot_speed"), nb::arg("reaction_time"), nb::arg("stopping_time"),
      nb::arg("stopping_distance"), nb::arg("intrusion"), nb::arg("human_uncertainty"), nb::arg("robot_uncertainty"),
      "The protective separation distance of ISO/TS 15066, which ISO 10218-2:2025 has taken over, in metres: "
      "human_speed "
      "(reaction_time + stopping_time) + robot_speed reaction_time + the other terms; m/s, s, m. Compare it with a "
      "result's lower. It is the formula and nothing more: no safety function. Raises ValueError for a number that is "
      "negative or not finite.");
}
