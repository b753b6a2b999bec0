// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/part_radii.hpp>

#include <clearance/ground/borrowed.hpp>
#include <clearance/io/kinematics.hpp>
#include <clearance/motion.hpp>
#include <clearance/questions/certain_distance.hpp>

namespace clearance::io {

std::vector<part_radius> part_radii(const kinematic_tree& tree, std::span<const std::size_t> links,
                                    std::span<const part_facts> facts, std::span<const double> q,
                                    const joint_uncertainty& of, joint_options options) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("clearance: " + why); };
  if (links.size() != facts.size())
    refuse("there are " + std::to_string(links.size()) + " links of parts, but " + std::to_string(facts.size()) +
           " facts");

  const auto given = [&](std::span<const double> each, const std::string& what, double least) {
    if (!each.empty() && each.size() != tree.size())
      refuse("the robot has " + std::to_string(tree.size()) + " values, but there are " + std::to_string(each.size()) +
             ' ' + what + "s");
    for (std::size_t i = 0; i < each.size(); ++i)
      if (!(each[i] >= least && std::isfinite(each[i])))
        refuse("the " + what + " of joint \"" + tree.movable(i).name + "\" is " + std::to_string(each[i]) +
               (least == 0 ? ", which must be 0 or more" : ", which is not finite"));
  };
  given(of.errors, "error", 0);
  given(of.speeds, "speed", -double(infinity));
  if (!(of.delay >= 0 && std::isfinite(of.delay)))
    refuse("a delay is " + std::to_string(of.delay) + " s, which must be 0 or more");

  std::vector<double> errors(tree.size()), together(tree.size());
  for (std::size_t i = 0; i < tree.size(); ++i) {
    errors[i] = of.errors.empty() ? 0 : of.errors[i];
    together[i] = errors[i] + (of.speeds.empty() ? 0 : std::abs(of.speeds[i]) * of.delay);
  }
  const std::vector<Eigen::Isometry3d> poses = tree.link_poses(q, options);

  const auto moved = [&](std::size_t link, const part_facts& of_part, const std::vector<double>& by_values) {
    double by = 0;  // by the joints so far, from the part down to the base: each is where it would be without the next
    const double radius = solid_radius(of_part);
    const Eigen::Vector3d center = poses[link] * center_of(of_part);
    for (std::size_t j; (j = tree.joint_above(link)) != tree.none; link = tree.link(tree.joints()[j].parent)) {
      const joint& above = tree.joints()[j];
      if (above.kind == joint_kind::fixed) continue;
      const double step = std::abs(tree.drive(j).factor) * by_values[tree.drive(j).value];
      if (step == 0) continue;
      const Eigen::Vector3d arm = center - poses[link].translation();
      by += above.kind == joint_kind::prismatic
                ? step
                : step * (arm.cross(poses[link].linear() * above.axis).norm() + radius + by);
    }
    return by * (1 + 0x1p-30);  // more than rounding takes
  };

  std::vector<part_radius> radii;
  for (std::size_t k = 0; k < links.size(); ++k) {
    if (links[k] >= tree.links().size())
      refuse("the robot has " + std::to_string(tree.links().size()) + " links, and none of number " +
             std::to_string(links[k]));
    const double joints = moved(links[k], facts[k], errors);
    radii.push_back({joints, std::max(0.0, moved(links[k], facts[k], together) - joints)});
  }
  return radii;
}

}  // namespace clearance::io
