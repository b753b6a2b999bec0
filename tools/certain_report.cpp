// SPDX-License-Identifier: BSD-3-Clause
#include "certain_report.hpp"

#include "report_text.hpp"

#include <clearance/io/part_radii.hpp>

#include <algorithm>
#include <cmath>

using namespace clearance;

namespace {

json shares_of(const uncertainty_shares& s) {
  return {{"noise", s.noise}, {"calibration", s.calibration}, {"time", s.time},        {"joints", s.joints},
          {"delay", s.delay}, {"gap", or_null(s.gap)},        {"rounding", s.rounding}};
}

/// One number for all values, or one each.
std::vector<double> each_of(const char* option, const std::vector<double>& given, const io::kinematic_tree& tree) {
  if (given.size() == 1) return std::vector<double>(tree.size(), given[0]);
  if (!given.empty() && given.size() != tree.size())
    throw usage_error(option, "needs one number, or one for each of the robot's " + std::to_string(tree.size()) +
                                  " movable joints; here are " + std::to_string(given.size()));
  return given;
}

/// A part's ball in its link's frame.
part_facts in_link(const part_facts& facts, const Eigen::Isometry3d& link_from_part) {
  part_facts moved = facts;
  const Eigen::Vector3d center = link_from_part * center_of(facts);
  moved.center = {real(center.x()), real(center.y()), real(center.z())};
  moved.radius = rounded_up(facts.radius + 0x1p-20 * center.norm());
  return moved;
}

/// The joints' errors and speeds, and the parts on their links.
struct wrong_joints {
  wrong_joints(const joints_off& wrong, const asked_robot& robot, std::span<const part_facts> facts)
      : tree(robot.description.kinematics()),
        errors(each_of("--joint-error", wrong.errors, tree)),
        speeds(each_of("--joint-speed", wrong.speeds, tree)) {
    for (std::size_t k = 0; k < facts.size(); ++k) {
      links.push_back(robot.link_of(k));
      const attached_thing* held = robot.held_as(k);
      placed.push_back(held ? in_link(facts[k], held->from.pose) : facts[k]);
    }
  }
  std::vector<part_radius> radii(const std::vector<double>& joints, const io::joint_uncertainty& of,
                                 io::joint_options options) const {
    auto found = io::part_radii(tree, links, placed, joints, of, options);
    for (const part_radius& r : found)
      if (!(r.sum() <= 1e15)) throw usage_error("--joint-error", "and --joint-speed move a link by more than 1e15 m");
    return found;
  }

  const io::kinematic_tree& tree;
  std::vector<double> errors, speeds;
  std::vector<std::size_t> links;
  std::vector<part_facts> placed;
};

/// Makes each radius at least as great as `other`'s.
void raise(std::vector<double>& radii, const std::vector<double>& other) {
  radii.resize(other.size());
  for (std::size_t k = 0; k < other.size(); ++k) radii[k] = std::max(radii[k], other[k]);
}

}  // namespace

std::vector<part_radius> radii_of(const query_options& asked, const asked_robot& robot,
                                  const std::vector<double>& joints, std::span<const part_facts> facts, double off) {
  const joints_off& wrong = *asked.certain;
  if (wrong.errors.empty() && wrong.speeds.empty()) return {};
  const wrong_joints of(wrong, robot, facts);
  return of.radii(joints, {of.errors, of.speeds, wrong.delay + off}, {asked.ignore_limits});
}

std::vector<double> summed_radii(const query_options& asked, const asked_robot& robot,
                                 const std::vector<double>& joints, std::span<const part_facts> facts, double off) {
  if (!asked.certain) return {};
  return sums(radii_of(asked, robot, joints, facts, off));
}

std::vector<double> radii_in_rows(const query_options& asked, const asked_robot& robot,
                                  const std::vector<std::vector<double>>& rows, std::span<const part_facts> facts) {
  std::vector<double> most;
  for (const std::vector<double>& row : rows) raise(most, summed_radii(asked, robot, row, facts));
  return most;
}

std::vector<double> radii_between_rows(const query_options& asked, const asked_robot& robot,
                                       const std::vector<std::vector<double>>& rows,
                                       std::span<const part_facts> facts) {
  if (!asked.certain || (asked.certain->errors.empty() && asked.certain->speeds.empty())) return {};
  const wrong_joints of(*asked.certain, robot, facts);
  std::vector<double> errors(of.tree.size()), half(of.tree.size()), most;
  for (std::size_t i = 0; i < errors.size(); ++i)
    errors[i] = (of.errors.empty() ? 0 : of.errors[i]) +
                (of.speeds.empty() ? 0 : std::abs(of.speeds[i]) * asked.certain->delay);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::vector<double>&from = rows[k - 1], &to = rows[k];
    double widest = 0;
    for (std::size_t i = 0; i < from.size(); ++i) widest = std::max(widest, std::abs(to[i] - from[i]));
    const int pieces = int(std::clamp(std::ceil(widest / 0.02), 1.0, 1000.0));
    for (std::size_t i = 0; i < from.size(); ++i) half[i] = std::abs(to[i] - from[i]) / (2 * pieces) * (1 + 0x1p-30);
    // Around the middle of a piece joints may be half of the piece away, and then their errors more: what the second
    // adds to the first is at least the radius anywhere in the piece, because levers grow by at most the first.
    for (int piece = 0; piece < pieces; ++piece) {
      std::vector<double> middle, radii;
      for (std::size_t i = 0; i < from.size(); ++i) middle.push_back(std::lerp(from[i], to[i], (piece + 0.5) / pieces));
      for (const part_radius& r : of.radii(middle, {half, errors, 1}, {.ignore_limits = true}))
        radii.push_back(r.delay);
      raise(most, radii);
    }
  }
  return most;
}

cloud_uncertainty carried_off(const query_options& asked, const asked_robot& robot, const std::vector<double>& joints,
                              const std::string& link, const Eigen::Isometry3d& carrier, const seen_points& seen,
                              double off) {
  cloud_uncertainty off_by = seen.off;
  if (!asked.certain || link.empty()) return off_by;
  const io::kinematic_tree& tree = robot.description.kinematics();
  const auto errors = each_of("--joint-error", asked.certain->errors, tree),
             speeds = each_of("--joint-speed", asked.certain->speeds, tree);
  const vec3 sensor = std::visit([](const auto& source) { return sensor_of(source); }, seen.points);
  part_facts camera{.radius = 0};  // a ball around the sensor, which moves by at most the ball's radius
  camera = in_link(camera, carrier.inverse() * seen.pose * Eigen::Translation3d(sensor.x, sensor.y, sensor.z));
  const std::size_t links[] = {tree.link(link)};
  off_by.shift +=
      io::part_radii(tree, links, std::span(&camera, 1), joints, {errors, speeds, off}, {asked.ignore_limits})[0].sum();
  for (std::size_t at = links[0], j; (j = tree.joint_above(at)) != tree.none; at = tree.link(tree.joints()[j].parent)) {
    const io::joint& above = tree.joints()[j];
    if (above.kind == io::joint_kind::fixed || above.kind == io::joint_kind::prismatic) continue;
    const auto [value, factor] = std::pair(tree.drive(j).value, std::abs(tree.drive(j).factor));
    off_by.turn +=
        factor * ((errors.empty() ? 0 : errors[value]) + (speeds.empty() ? 0 : std::abs(speeds[value]) * off));
  }
  return off_by;
}

json certain_of(const certain_pair& pair, const std::vector<const observation*>& clouds) {
  if (pair.part == none) return nullptr;
  const observation* const cloud = clouds[pair.cloud];
  const auto at = pixel(*cloud, pair.point);
  return {{"lower", pair.lower},
          {"distance", or_null(pair.distance)},
          {"cloud", cloud->name},
          {"point", pair.point},
          {"pixel", at ? json{at->first, at->second} : json(nullptr)},
          {"point_xyz", {pair.at.x, pair.at.y, pair.at.z}},
          {"primitive", pair.primitive == none ? json(nullptr) : json(pair.primitive)},
          {"nearest_xyz", {pair.nearest.x, pair.nearest.y, pair.nearest.z}},
          {"shares", shares_of(pair.shares)}};
}

json certain_of(const certain_distance_result& r, const std::vector<const observation*>& clouds,
                const std::vector<body>& bodies) {
  json out = {{"state", to_string(r.state)}, {"lower", r.lower}, {"upper", or_null(r.upper)}, {"anywhere", r.anywhere}};
  out["part"] = r.certain.part == none ? json(nullptr) : json(bodies[r.certain.part].name);
  out["pair"] = certain_of(r.certain, clouds);
  return out;
}

std::string certain_text(const certain_distance_result& r, const std::vector<body>& bodies) {
  std::string out = text("certain   %s: %.6f to %.6f m", to_string(r.state), double(r.lower), double(r.upper));
  if (r.certain.part == none) return out + '\n';
  const uncertainty_shares& s = r.certain.shares;
  out += ", by " + io::printable(bodies[r.certain.part].name) +
         text(" and point %u, which is measured %.6f m away\n", r.certain.point, double(r.certain.distance));
  return out + text(
                   "          less noise %.6f, calibration %.6f, time %.6f, joints %.6f, delay %.6f, gap %.6f, "
                   "rounding %.6f\n",
                   s.noise, s.calibration, s.time, s.joints, s.delay, s.gap, s.rounding);
}

void note_anywhere(std::uint64_t count, std::vector<std::string>& notes) {
  if (count != 0)
    notes.push_back(
        text("%llu points may be anywhere, so nothing is free: they are too close to be measured, or where "
             "--sensor measures nothing, such as behind a camera (z is forward)",
             (unsigned long long)count));
}
