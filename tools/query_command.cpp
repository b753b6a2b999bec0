// SPDX-License-Identifier: BSD-3-Clause
#include "asked_robot.hpp"
#include "command_line.hpp"
#include "messages.hpp"
#include "observations.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

#include <clearance/io/scene.hpp>

#include <CLI/CLI.hpp>

#include <iostream>

using namespace clearance;

namespace {

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
  io::files_read inputs;
  const io::robot robot = load_robot(asked);
  const auto joints = about_file(asked.robot, [&] { return configuration(asked, robot.kinematics()); });
  const io::joint_options limits{asked.ignore_limits};
  query_report report;
  report.notes = robot.notes();
  question q{asked.model, asked.volume, nullptr, placed_links(asked, robot, joints), {}};
  std::vector<observation> clouds;
  for (const cloud_options& from : asked.clouds) {
    shown.show("reading " + from.file);
    clouds.push_back(observe(from));
    for (const auto& note : clouds.back().notes) report.notes.push_back(note);
  }
  for (observation& cloud : clouds) {  // they stay where they are from here on
    Eigen::Isometry3d carrier = Eigen::Isometry3d::Identity();
    if (const auto& link = cloud.from.link; !link.empty())
      carrier = asked.base * about_file(asked.robot, [&] { return robot.link_pose(link, joints, limits); });
    q.clouds.push_back(about_file(cloud.from.file, [&] {
      const seen_points seen = cloud.seen(carrier, q.poses);
      rigid(seen.pose, "cloud");
      return seen;
    }));
  }
  if (!asked.scene.empty()) io::check_output(asked.scene, inputs);  // known before the robot is packed
  report.load = clock.lap();

  const std::vector<body> bodies = make_bodies(asked, robot, shown, report.notes);
  report.pack = clock.lap();
  q.bodies = &bodies;
  shown.show("asking");
  report.found = asked.on_device ? ask_device(q) : ask_host(q);
  for (const observation& cloud : clouds) cloud.recount(report.found.result);
  report.asked = &asked;
  report.clouds = &clouds;
  report.bodies = &bodies;
  if (!asked.scene.empty()) {
    io::check_output(asked.scene, inputs);
    draw(report, robot, q);
  }
  shown.clear();
  say_notes(report.notes);
  std::cout << (asked.json ? to_json(report) : to_text(report));
  const min_distance_result& r = report.found.result;
  if (r.state == state::no_data) return 3;
  return asked.margin && !(r.lower > *asked.margin) ? 2 : 0;
}

}  // namespace

subcommand add_query(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("query", "The least distance between a robot and what a sensor saw");
  return [options = add_query_options(*sub, asking::query)] { return run(options()); };
}
