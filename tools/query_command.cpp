// SPDX-License-Identifier: BSD-3-Clause
#include "asked_clouds.hpp"
#include "command_line.hpp"
#include "distances_file.hpp"
#include "messages.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
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

void draw(const query_report& report, const io::robot& robot, poses_of poses, const asked_clouds& clouds, const point_distances* distances) {
  io::scene scene;
  const min_distance_result& r = report.found.result;
  // A glTF file holds floats: a scene far away is drawn around its robot.
  const Eigen::Vector3d base = report.asked->base.translation();
  if (base.norm() > 1000) scene.origin = base;
  for (std::size_t k = 0; k < robot.parts().size(); ++k) {
    scene.bodies.push_back({.name = robot.parts()[k].name, .mesh = robot.parts()[k].mesh, .pose = poses[k]});
    if (r.part == k) scene.bodies.back().paint = {0.95f, 0.6f, 0.2f, 1};
  }
  std::size_t first = 0;
  for (std::size_t i = 0; i < clouds.files.size(); ++i) {
    scene.clouds.push_back(drawn(*report.asked, clouds.files[i], clouds.seen[i], distances, first));
    first += clouds.files[i].size();
  }
  if (r.state != state::no_data)
    scene.segments.push_back({.name = "witness", .from = {r.nearest.x, r.nearest.y, r.nearest.z}, .to = {r.at.x, r.at.y, r.at.z}});
  io::save_scene(scene, report.asked->scene);
}

/// What is written is no input, and not two things.
void check_outputs(const query_options& asked, const io::files_read& inputs) {
  if (!asked.scene.empty()) io::check_output(asked.scene, inputs);
  if (!asked.distances.empty()) io::check_output(asked.distances, inputs);
  const auto where = [](const std::string& file) { return std::filesystem::weakly_canonical(file); };
  if (!asked.scene.empty() && !asked.distances.empty() && where(asked.scene) == where(asked.distances))
    throw usage_error("--distances", "is the same file as --scene: " + asked.distances);
}

int run(const query_options& asked) {
  stopwatch clock;
  progress shown;
  shown.show("reading " + asked.robot);
  io::files_read inputs;
  const io::robot robot = load_robot(asked);
  const auto joints = about_file(asked.robot, [&] { return configuration(asked, robot.kinematics()); });
  query_report report;
  report.asked = &asked;
  report.notes = robot.notes();
  const std::vector<Eigen::Isometry3d> poses = placed_links(asked, robot, joints);
  asked_clouds clouds;
  clouds.load(asked, shown, report.notes);
  clouds.place(asked, robot, joints, poses);
  check_outputs(asked, inputs);  // known before the robot is packed
  report.load = clock.lap();

  const std::vector<body> bodies = make_bodies(asked, robot, shown, report.notes);
  report.pack = clock.lap();
  report.clouds = &clouds.files;
  report.bodies = &bodies;
  shown.show("asking");
  const auto there = robot_on(asked.on_device, {asked.model, asked.volume, &bodies});
  report.upload = there->see(clouds.seen);
  report.found = there->least_per_part(poses, 1);
  report.query = there->query;
  if (!asked.zones.empty()) report.zones = there->zones(poses, {.thresholds = asked.zones, .min_points = asked.min_points});
  std::optional<point_distances> distances;
  if (!asked.distances.empty()) distances = there->distances(poses, asked.d_max);
  report.build = there->build;
  report.upload += there->upload;
  for (const observation& cloud : clouds.files) cloud.recount(report.found.result);
  check_outputs(asked, inputs);
  if (distances) report.distances = write_distances(asked, clouds, *distances);
  if (!asked.scene.empty()) draw(report, robot, poses, clouds, distances ? &*distances : nullptr);
  shown.clear();
  say_notes(report.notes);
  std::cout << (asked.json ? to_json(report) : to_text(report));
  if (report.found.result.state == state::no_data) return 3;
  const bool stopped = report.zones && report.zones->innermost() == 0;
  return stopped || (asked.margin && !report.passes()) ? 2 : 0;
}

}  // namespace

subcommand add_query(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("query", "The least distance between a robot and what a sensor saw");
  return [options = add_query_options(*sub, asking::query)] { return run(options()); };
}
