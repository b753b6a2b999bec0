// SPDX-License-Identifier: BSD-3-Clause
#include "asked_robot.hpp"

#include "command_line.hpp"
#include "robot_bodies.hpp"

#include <clearance/io/spheres_file.hpp>

#include <cstdio>

using namespace clearance;

namespace {

/// The spheres of --packing by the number of their link; nullptr for links that it does not name.
std::vector<const io::packed_part*> assigned(const std::vector<io::packed_part>& given, const io::robot& robot,
                                             const query_options& asked) {
  const auto& parts = robot.parts();
  std::vector<const io::packed_part*> to(parts.size(), nullptr);
  if (given.size() == 1 && parts.size() == 1) return {&given[0]};  // whatever it is called
  for (const io::packed_part& each : given) {
    const auto at = std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.name == each.name; });
    if (at != parts.end())
      to[std::size_t(at - parts.begin())] = &each;
    else if (std::find(asked.excluded.begin(), asked.excluded.end(), each.name) == asked.excluded.end())
      throw usage_error("--packing", asked.packing + " has spheres for \"" + each.name +
                                         "\", which is no link with geometry (--exclude-link leaves a link out)");
  }
  return to;
}

void note_packing(const query_options& asked, const body_account& account, std::vector<std::string>& notes) {
  if (asked.packing.empty()) return;
  const auto mm = [](double metres) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f mm", 1e3 * metres);
    return std::string(text);
  };
  if (account.proven > 0)
    notes.push_back(asked.packing + ": the spheres of " + std::to_string(account.proven) +
                    " links have no certificate for these meshes, and were measured: the meshes are nowhere farther "
                    "from them than " +
                    mm(account.largest_gap) + ", and they stick out by at most " + mm(account.largest_excess));
  if (const std::size_t rest = account.packed + account.from_cache; rest > 0)
    notes.push_back(asked.packing + ": has no spheres for " + std::to_string(rest) + " links, which were packed");
}

}  // namespace

io::robot load_robot(const query_options& asked) {
  io::robot_options options;
  options.geometry = asked.visual.value_or(false) ? io::robot_geometry::visual : io::robot_geometry::collision;
  for (const auto& [name, folder] : asked.packages) options.packages[name] = folder;
  options.exclude_links = asked.excluded;
  options.limits = asked.limits;
  return io::within_memory(asked.robot, [&] { return about_file(asked.robot, [&] { return io::load_robot(asked.robot, options); }); });
}

std::vector<Eigen::Isometry3d> placed_links(const query_options& asked, const io::robot& robot,
                                            const std::vector<double>& joints, const std::string& when) {
  return about_file(asked.robot, [&] {
    auto poses = robot.poses(joints, {asked.ignore_limits});
    for (std::size_t k = 0; k < poses.size(); ++k) {
      poses[k] = asked.base * poses[k];
      rigid(poses[k], ("link " + io::quoted(robot.parts()[k].name) + when).c_str());
    }
    return poses;
  });
}

std::vector<body> make_bodies(const query_options& asked, const io::robot& robot, progress& shown,
                              std::vector<std::string>& notes) {
  std::vector<io::packed_part> given;
  if (!asked.packing.empty()) given = io::within_memory(asked.packing, [&] { return io::load_spheres(asked.packing); });
  const auto spheres_of = assigned(given, robot, asked);
  std::vector<body_source> sources;
  for (std::size_t k = 0; k < robot.parts().size(); ++k) {
    const io::robot_part& part = robot.parts()[k];
    sources.push_back({part.name, &part.mesh, part.tessellation_error, spheres_of[k]});
  }
  const body_options how{
      .model = asked.model, .pack = {.count = asked.spheres}, .cache = chosen_cache(asked.no_cache, asked.cache)};
  body_account account;
  std::vector<body> bodies;
  try {
    bodies = make_bodies(sources, how, shown, account);
  } catch (const std::runtime_error& error) {  // it names the link
    io::refuse(asked.robot, error.what());
  }
  note_packing(asked, account, notes);
  return bodies;
}
