// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"
#include "observations.hpp"
#include "query_options.hpp"
#include "report.hpp"
#include "robot_bodies.hpp"
#include "stopwatch.hpp"

#include <clearance/io/robot.hpp>
#include <clearance/io/scene.hpp>
#include <clearance/io/spheres_file.hpp>

#include <CLI/CLI.hpp>

#include <iostream>

using namespace clearance;

namespace {

io::robot load(const query_options& asked) {
  io::robot_options options;
  options.geometry = asked.visual.value_or(false) ? io::robot_geometry::visual : io::robot_geometry::collision;
  for (const auto& [name, folder] : asked.packages) options.packages[name] = folder;
  options.exclude_links = asked.excluded;
  return io::load_robot(asked.robot, options);
}

std::vector<double> configuration(const query_options& asked, const io::kinematic_tree& tree) {
  if (!asked.joints.empty()) {
    if (asked.joints.size() == tree.size()) return asked.joints;
    std::string names;
    for (std::size_t i = 0; i < tree.size(); ++i) names += (i ? "," : "") + tree.movable(i).name;
    throw usage_error("--joints", "the robot has " + std::to_string(tree.size()) + " movable joints (" + names + "), here are " +
                                      std::to_string(asked.joints.size()) + " values");
  }
  return tree.configuration({asked.joint.begin(), asked.joint.end()}, {asked.ignore_limits});
}

/// The spheres of --packing by the number of their link; nullptr for links that it does not name.
std::vector<const io::packed_part*> assigned(const std::vector<io::packed_part>& given, const io::robot& robot, const query_options& asked) {
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
                    " links have no certificate for these meshes, and were measured: the meshes are nowhere farther from them than " +
                    mm(account.largest_gap) + ", and they stick out by at most " + mm(account.largest_excess));
  if (const std::size_t rest = account.packed + account.from_cache; rest > 0)
    notes.push_back(asked.packing + ": has no spheres for " + std::to_string(rest) + " links, which were packed");
}

void draw(const query_report& report, const io::robot& robot, const question& asked) {
  io::scene scene;
  const min_distance_result& r = report.found.result;
  // A glTF file holds floats: a scene far away is drawn around its robot.
  const Eigen::Vector3d base = report.asked->base.translation();
  if (base.norm() > 1000) scene.origin = base;
  for (std::size_t k = 0; k < robot.parts().size(); ++k) {
    scene.bodies.push_back({.name = robot.parts()[k].name, .mesh = robot.parts()[k].mesh, .pose = asked.poses[k]});
    if (r.part == k) scene.bodies.back().paint = {0.95f, 0.6f, 0.2f, 1};
  }
  for (std::size_t i = 0; i < asked.clouds.size(); ++i)
    scene.clouds.push_back({.name = (*report.clouds)[i].from.file, .points = valid_points(asked.clouds[i]), .pose = asked.clouds[i].pose});
  if (r.state != state::no_data)
    scene.segments.push_back({.name = "witness", .from = {r.nearest.x, r.nearest.y, r.nearest.z}, .to = {r.at.x, r.at.y, r.at.z}});
  io::save_scene(scene, report.asked->scene);
}

int run(const query_options& asked) {
  stopwatch clock;
  progress shown;
  shown.show("reading " + asked.robot);
  const io::robot robot = load(asked);
  const auto joints = configuration(asked, robot.kinematics());
  const io::joint_options limits{asked.ignore_limits};
  query_report report;
  report.notes = robot.notes();
  question q{asked.model, asked.volume, nullptr, {}, {}};
  for (const auto& pose : robot.poses(joints, limits)) q.poses.push_back(asked.base * pose);
  std::vector<observation> clouds;
  for (const cloud_options& from : asked.clouds) {
    shown.show("reading " + from.file);
    clouds.push_back(observe(from));
    for (const auto& note : clouds.back().notes) report.notes.push_back(note);
  }
  for (const observation& cloud : clouds)  // the clouds stay where they are from here on
    q.clouds.push_back(cloud.seen(cloud.from.link.empty() ? Eigen::Isometry3d::Identity()
                                                          : asked.base * robot.link_pose(cloud.from.link, joints, limits)));
  report.load = clock.lap();

  std::vector<body> bodies;
  std::vector<io::packed_part> given;
  if (!asked.packing.empty()) given = io::load_spheres(asked.packing);
  const auto spheres_of = assigned(given, robot, asked);
  const io::packing_cache cache = chosen_cache(asked.no_cache, asked.cache);
  body_account account;
  for (std::size_t k = 0; k < robot.parts().size(); ++k) {
    const io::robot_part& part = robot.parts()[k];
    const body_options how{.model = asked.model, .pack = {.count = asked.spheres}, .cache = &cache, .given = spheres_of[k]};
    bodies.push_back(make_body(part.name, part.mesh, part.tessellation_error, how, shown, account));
  }
  note_packing(asked, account, report.notes);
  report.pack = clock.lap();
  q.bodies = &bodies;
  shown.show("asking");
  report.found = asked.on_device ? ask_device(q) : ask_host(q);
  for (const observation& cloud : clouds) {  // what was turned into NaN was missing
    report.found.result.dropped[int(drop_reason::not_finite)] -= cloud.zeros;
    report.found.result.dropped[int(drop_reason::missing)] += cloud.zeros;
  }
  report.asked = &asked;
  report.clouds = &clouds;
  report.bodies = &bodies;
  if (!asked.scene.empty()) draw(report, robot, q);
  shown.clear();
  for (const auto& note : report.notes) std::cerr << "note: " << note << '\n';
  std::cout << (asked.json ? to_json(report) : to_text(report));
  const min_distance_result& r = report.found.result;
  if (r.state == state::no_data) return 3;
  return asked.margin && !(r.lower > *asked.margin) ? 2 : 0;
}

}  // namespace

subcommand add_query(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("query", "The least distance between a robot and what a sensor saw");
  return [options = add_query_options(*sub)] { return run(options()); };
}
