// SPDX-License-Identifier: BSD-3-Clause
#include "asked_robot.hpp"

#include <clearance/io/error.hpp>
#include "command_line.hpp"
#include "kept_packings.hpp"
#include "noted_files.hpp"
#include "recording.hpp"
#include "robot_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace clearance;

namespace {

/// The spheres of --packing by link number; nullptr for links that it does not name.
std::vector<const io::packed_part*> assigned(const std::vector<io::packed_part>& given, const io::robot& robot,
                                             const query_options& asked) {
  const auto& parts = robot.parts();
  std::vector<const io::packed_part*> to(parts.size(), nullptr);
  if (given.size() == 1 && parts.size() == 1) return {&given[0]};  // whatever its name is
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

/// "claw+cup.stl", or "claw+cup.stl (2)" if that is taken.
std::string name_of(const attachment_options& from, const asked_robot& robot) {
  const std::string plain = from.link + '+' + std::filesystem::path(from.file).filename().string();
  const auto taken = [&](const std::string& name) {
    return std::ranges::any_of(robot.description.parts(), [&](const auto& part) { return part.name == name; }) ||
           std::ranges::any_of(robot.held, [&](const auto& thing) { return thing.name == name; });
  };
  std::string name = plain;
  for (int k = 2; taken(name); ++k) name = plain + " (" + std::to_string(k) + ')';
  return name;
}

attached_thing load_attached(const query_options& asked, const attachment_options& from, const asked_robot& robot,
                             std::vector<std::string>& notes) {
  attached_thing made{.name = name_of(from, robot), .from = from, .link = 0, .mesh = {}, .spheres = {}};
  try {
    made.link = robot.description.kinematics().link(from.link);
  } catch (const std::invalid_argument& error) {
    throw usage_error("--attach", error.what());
  }
  if (io::spheres_format(from.file).empty()) {
    made.mesh = noted_mesh(from.file, asked.limits, asked.gltf_up, notes);
    return made;
  }
  if (asked.model != model_kind::spheres)
    throw usage_error("--attach", from.file + " holds spheres, which are for --model spheres");
  auto parts = io::within_memory(from.file, [&] { return noted_spheres(from.file, asked.limits, notes); });
  if (parts.size() != 1)
    io::refuse(from.file,
               "holds the spheres of " + std::to_string(parts.size()) + " parts, and --attach takes those of one");
  if (!std::isfinite(parts[0].spheres.gap)) {
    parts[0].spheres.gap = 0;  // no mesh is known that they stand for
    notes.push_back(from.file + ": has no certificate, so its spheres themselves are taken for what link " +
                    io::quoted(from.link) + " holds");
  }
  made.spheres = std::move(parts[0]);
  return made;
}

body_options body_options_of(const query_options& asked) {
  return {.spheres = asked.model == model_kind::spheres,
          .pack = {.count = asked.spheres.value_or(pack_options{}.count)},
          .cache = chosen_cache(asked.no_cache, asked.cache)};
}

body make_held(const query_options& asked, const attached_thing& thing, progress& shown,
               std::vector<std::string>& notes) {
  if (thing.spheres) return {thing.name, thing.spheres->spheres, {}, thing.spheres->tolerance};
  const body_source source{thing.name, &thing.mesh};
  body_account account;
  try {
    body made = std::move(make_bodies(std::vector{source}, body_options_of(asked), shown, account)[0]);
    notes.insert(notes.end(), account.notes.begin(), account.notes.end());
    return made;
  } catch (const std::runtime_error& error) {  // its file identifies it, not a link
    std::string why = error.what();
    if (const std::string link = "link " + io::quoted(thing.name) + ": "; why.starts_with(link))
      why.erase(0, link.size());
    io::refuse(thing.from.file, why);
  }
}

}  // namespace

asked_robot load_robot(const query_options& asked, std::vector<std::string>& notes) {
  io::robot_options options;
  options.geometry = asked.visual.value_or(false) ? io::robot_geometry::visual : io::robot_geometry::collision;
  options.packages = asked.packages;
  options.gltf_up = asked.gltf_up;
  options.exclude_links = asked.excluded;
  options.strict = asked.strict;
  options.limits = asked.limits;
  asked_robot made{
      io::within_memory(asked.robot,
                        [&] { return about_file(asked.robot, [&] { return io::load_robot(asked.robot, options); }); }),
      {}};
  notes.insert(notes.end(), asked.notes.begin(), asked.notes.end());
  notes.insert(notes.end(), made.description.notes().begin(), made.description.notes().end());
  const auto own = io::followers_among(made.description.kinematics(), joints_named(asked));
  for (const std::string& name : own) notes.push_back(io::note_on_freed(made.description.kinematics(), name));
  made.description.free_joints(own);
  for (const attachment_options& from : asked.attached) made.held.push_back(load_attached(asked, from, made, notes));
  return made;
}

std::vector<double> named_configuration(const query_options& asked, const io::kinematic_tree& tree) {
  if (!asked.joints.empty()) {
    if (asked.joints.size() == tree.size()) return asked.joints;
    std::string names;
    for (std::size_t i = 0; i < tree.size(); ++i) names += (i ? "," : "") + tree.movable(i).name;
    throw usage_error("--joints", "the robot has " + std::to_string(tree.size()) + " movable joints (" + names +
                                      "), here are " + std::to_string(asked.joints.size()) + " values");
  }
  return tree.configuration({asked.joint.begin(), asked.joint.end()}, {asked.ignore_limits});
}

std::vector<Eigen::Isometry3d> all_links(const query_options& asked, const io::robot& robot,
                                         const std::vector<double>& joints) {
  return about_file(asked.robot, [&] {
    auto links = robot.kinematics().link_poses(joints, {asked.ignore_limits});
    for (std::size_t k = 0; k < links.size(); ++k)
      links[k] = io::carried(asked.base, links[k], "link " + io::quoted(robot.kinematics().links()[k]));
    return links;
  });
}

std::vector<Eigen::Isometry3d> placed_links(const query_options& asked, const asked_robot& robot,
                                            const std::vector<double>& joints, const std::string& when) {
  const auto links = all_links(asked, robot.description, joints);
  std::vector<Eigen::Isometry3d> poses;
  return about_file(asked.robot, [&] {
    for (const io::robot_part& part : robot.description.parts()) {
      poses.push_back(links[part.link]);
      rigid(poses.back(), ("link " + io::quoted(part.name) + when).c_str());
    }
    for (const attached_thing& thing : robot.held) {
      poses.push_back(io::carried(links[thing.link], thing.from.pose, io::quoted(thing.name) + when));
      rigid(poses.back(), (io::quoted(thing.name) + when).c_str());
    }
    return poses;
  });
}

std::vector<body> make_bodies(const query_options& asked, const asked_robot& robot, progress& shown,
                              std::vector<std::string>& notes, field_use fields) {
  const bool named = !asked.cache.empty();
  if (asked.model == model_kind::spheres || fields == field_use::always || named)
    check_kept(body_options_of(asked).cache, named, notes);

  std::vector<io::packed_part> given;
  if (!asked.packing.empty())
    given = io::within_memory(asked.packing, [&] { return noted_spheres(asked.packing, asked.limits, notes); });
  const auto spheres_of = assigned(given, robot.description, asked);
  const bool packs_held = std::ranges::any_of(robot.held, [](const auto& thing) { return !thing.spheres; });
  if (asked.spheres && !packs_held && std::ranges::count(spheres_of, nullptr) == 0)
    throw usage_error("--spheres", "is for links that are packed, and " + asked.packing + " has spheres for all");

  std::vector<body_source> sources;
  for (std::size_t k = 0; k < robot.description.parts().size(); ++k) {
    const io::robot_part& part = robot.description.parts()[k];
    sources.push_back({part.name, &part.mesh, part.tessellation_error, spheres_of[k]});
  }
  body_account account;
  std::vector<body> bodies;
  try {
    bodies = make_bodies(sources, body_options_of(asked), shown, account);
  } catch (const std::runtime_error& error) {  // it names the link
    io::refuse(asked.robot, error.what());
  }

  note_packing(asked, account, notes);
  notes.insert(notes.end(), account.notes.begin(), account.notes.end());
  for (const attached_thing& thing : robot.held) bodies.push_back(make_held(asked, thing, shown, notes));
  return bodies;
}
