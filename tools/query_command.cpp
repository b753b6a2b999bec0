// SPDX-License-Identifier: BSD-3-Clause
#include "asked_clouds.hpp"
#include "command_line.hpp"
#include "distances_file.hpp"
#include "filter_report.hpp"
#include "messages.hpp"
#include "query_print.hpp"
#include "ranks.hpp"
#include "report_text.hpp"
#include "scale_notes.hpp"
#include "stopwatch.hpp"

#include <clearance/io/error.hpp>
#include <clearance/io/hidden_mesh.hpp>
#include <clearance/io/jacobian.hpp>
#include <clearance/io/write_file.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>

using namespace clearance;

namespace {

/// How each part's distance changes.
std::vector<part_gradient> gradients(const query_options& asked, const asked_robot& robot,
                                     const std::vector<double>& joints, poses_of poses,
                                     std::span<const part_witness> witnesses) {
  const io::kinematic_tree& tree = robot.description.kinematics();
  const std::vector<Eigen::Isometry3d> links = all_links(asked, robot.description, joints);
  std::vector<part_gradient> made;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    made.push_back({gradient(witnesses[k], Eigen::Vector3d(poses[k].translation())), {}});
    made.back().of_joints = io::joint_gradient(tree, links, robot.link_of(k), made.back().of_pose);
  }
  return made;
}

/// What the images hide, and the way behind the pixel that hides it nearest to the robot.
void draw_unseen(const query_report& report, const asked_clouds& clouds, io::scene& scene) {
  const min_distance_result& r = report.unseen->all;
  std::span<const point_label> labels;
  if (report.filter) labels = report.filter->labels;
  for (std::size_t i = 0; i < clouds.files.size(); ++i) {
    const auto& image = std::get<depth_image<std::uint16_t>>(clouds.seen[i].points);
    const auto labels_of_image = labels.first(std::min(labels.size(), image.size()));
    scene.bodies.push_back({.name = clouds.files[i].name + " hides",
                            .mesh = io::hidden_mesh(image, *report.asked->unseen, labels_of_image),
                            .pose = clouds.seen[i].pose,
                            .paint = {0.5f, 0.3f, 0.6f, 0.25f}});
    labels = labels.subspan(labels_of_image.size());
  }
  if (r.cloud == none) return;
  const hidden source{std::get<depth_image<std::uint16_t>>(clouds.seen[r.cloud].points), *report.asked->unseen, 0};
  const capsule way = source.around(r.point, source[r.point].position);
  const auto world = [&](vec3 p) {
    return Eigen::Vector3d(clouds.seen[r.cloud].pose * Eigen::Vector3d(p.x, p.y, p.z));
  };
  const io::colour violet{0.6f, 0.1f, 0.8f, 1};
  scene.segments.push_back({.name = "hidden way", .from = world(way.from), .to = world(way.at(1)), .paint = violet});
  scene.segments.push_back({.name = "witness of what is hidden",
                            .from = {r.nearest.x, r.nearest.y, r.nearest.z},
                            .to = {r.at.x, r.at.y, r.at.z},
                            .paint = violet});
}

void draw(const query_report& report, const asked_robot& robot, poses_of poses, const asked_clouds& clouds,
          const point_distances* distances) {
  io::scene scene;
  const min_distance_result& r = report.found.result;
  // A glTF file holds floats, so a scene far away is drawn relative to its robot.
  const Eigen::Vector3d base = report.asked->base.translation();
  if (base.norm() > 1000) scene.origin = base;

  const io::colour nearest{0.95f, 0.6f, 0.2f, 1};
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const attached_thing* held = robot.held_as(k);
    if (held && held->spheres) {
      scene.balls.push_back({.name = held->name, .balls = {}, .pose = poses[k]});
      for (const inner_sphere& s : held->spheres->spheres.spheres)
        scene.balls.back().balls.push_back({s.center, s.radius});
      if (r.part == k) scene.balls.back().paint = nearest;
      continue;
    }
    const triangle_mesh& mesh = held ? held->mesh : robot.description.parts()[k].mesh;
    scene.bodies.push_back({.name = (*report.bodies)[k].name, .mesh = mesh, .pose = poses[k]});
    if (r.part == k) scene.bodies.back().paint = nearest;
  }

  std::size_t first = 0;
  for (std::size_t i = 0; i < clouds.files.size(); ++i) {
    scene.clouds.push_back(drawn(*report.asked, clouds.files[i], clouds.seen[i], distances, first));
    first += clouds.files[i].size();
    const auto in_grey = [&](const char* what, const std::vector<vec3>& points) {
      if (points.empty()) return;
      scene.clouds.push_back({.name = clouds.files[i].name + what,
                              .points = points,
                              .pose = clouds.seen[i].pose,
                              .paint = {0.55f, 0.55f, 0.55f, 1}});
    };
    if (!clouds.hidden.empty()) in_grey(" (the robot's own)", clouds.hidden[i]);
    in_grey(" (cropped)", cropped_points(clouds.seen[i]));
  }

  if (r.state != state::no_data)
    scene.segments.push_back(
        {.name = "witness", .from = {r.nearest.x, r.nearest.y, r.nearest.z}, .to = {r.at.x, r.at.y, r.at.z}});
  if (report.unseen) draw_unseen(report, clouds, scene);
  io::save_scene(scene, report.asked->scene);
}

/// Refuses to write an input, or two outputs to one file.
void check_outputs(const query_options& asked, const io::files_read& inputs) {
  if (!asked.scene.empty()) io::check_output(asked.scene, inputs);
  if (!asked.distances.empty()) io::check_output(asked.distances, inputs);
  const auto where = [](const std::string& file) { return std::filesystem::weakly_canonical(file); };
  if (!asked.scene.empty() && !asked.distances.empty() && where(asked.scene) == where(asked.distances))
    throw usage_error("--distances", "is the same file as --scene: " + asked.distances);
}

/// Asks for the least distance and for all that the options name, but for the distances of all points.
void ask_questions(query_report& report, backend_robot& there, poses_of poses, const std::vector<double>& joints) {
  const query_options& asked = *report.asked;
  report.found = asked.deadline ? there.least_by(poses, *asked.deadline / 1000) : there.least_per_part(poses, 1);
  report.query = there.query;
  const std::vector<double> radii = summed_radii(asked, *report.robot, joints, there.facts());
  if (!asked.zones.empty())
    report.zones = there.zones(poses, {.thresholds = asked.zones, .min_points = asked.min_points, .radii = radii});
  if (asked.nearest != 0) {
    std::size_t points = 1;  // for more points there is no list
    for (const observation& cloud : *report.clouds) points += cloud.size();
    report.nearest = there.nearest(poses, std::min(asked.nearest, points), asked.d_max);
  }
  if (asked.support)
    report.support = there.supported(
        poses, {.min_points = asked.support->min_points, .radius = asked.support->radius, .most = asked.support->most});
  if (asked.certain) {
    report.certain = there.certain(poses, radii_of(asked, *report.robot, joints, there.facts()));
    note_anywhere(report.certain->anywhere, report.notes);
  }
  if (asked.unseen && !report.unseen)
    report.unseen = there.unseen(poses, {.room = *asked.unseen, .radii = radii}, false);
  if (asked.gradient)
    report.gradients = gradients(asked, *report.robot, joints, poses, there.witnesses(poses, report.found.parts));
}

int exit_code(const query_report& report) {
  if (report.found.result.state == state::no_data) return 3;
  const bool stopped = report.zones && report.zones->innermost() == 0;
  const bool passes = !report.asked->margin || (report.passes() && (!report.unseen || report.of_unseen().passes()));
  return stopped || !passes ? 2 : 0;
}

/// `ranks`: those of --shard.
int run(const query_options& asked, all_ranks* ranks) {
  const bool speaks = !ranks || ranks->speaks();
  stopwatch clock;
  progress shown;
  shown.show("reading " + asked.robot);
  io::files_read inputs;
  query_report report;
  report.asked = &asked;
  const asked_robot robot = load_robot(asked, report.notes);
  report.robot = &robot;
  const auto joints =
      about_file(asked.robot, [&] { return named_configuration(asked, robot.description.kinematics()); });
  const std::vector<Eigen::Isometry3d> poses = placed_links(asked, robot, joints);
  asked_clouds clouds;
  clouds.load(asked, shown, report.notes);
  clouds.place(asked, robot, joints, poses);
  if (speaks) check_outputs(asked, inputs);  // fail before the robot is packed
  report.load = clock.lap();

  const std::vector<body> bodies = make_bodies(asked, robot, shown, report.notes);
  report.pack = clock.lap();
  report.clouds = &clouds.files;
  report.bodies = &bodies;
  shown.show("asking");
  const asked_model model{.model = asked.model,
                          .volume = asked.volume,
                          .bodies = &bodies,
                          .cells = asked.cells && asked.on_device};  // a host looks into none
  auto robot_there = robot_on(asked.on_device, model);
  if (ranks) robot_there->join(*ranks, asked.alike);
  report.upload = robot_there->see(clouds.seen);

  if (asked.self_filter) {
    own_points own =
        hide_own_points(asked, *robot_there, poses, clouds, summed_radii(asked, robot, joints, robot_there->facts()));
    report.filter = std::move(own.filter);
    report.unseen = std::move(own.unseen);
    report.upload += own.upload;
    note_hidden(asked, report.notes);
  }

  ask_questions(report, *robot_there, poses, joints);
  note_scale(clouds.seen, bodies, poses, report.found.result, report.notes);
  std::optional<point_distances> distances;
  if (!asked.distances.empty()) distances = robot_there->distances(poses, asked.d_max, asked.is_signed);
  if (ranks) ranks->part();
  if (!speaks) return 0;

  report.build = robot_there->build;
  report.cells = robot_there->cells;
  report.cells_bytes = robot_there->cells_bytes;
  for (std::size_t k = 0; k < robot_there->without_cells.size(); ++k)
    if (const std::string& why_not = robot_there->without_cells[k]; !why_not.empty())
      report.notes.push_back("--cells: link " + io::quoted(bodies[k].name) + ": " + why_not);
  if (asked.cells && !model.cells) report.notes.push_back("--cells: none are made, because the host looks into none");
  report.upload += robot_there->upload;
  if (report.found.unseen == 0)  // otherwise it is unknown which of them were seen
    for (const observation& cloud : clouds.files) cloud.recount(report.found.result);
  check_outputs(asked, inputs);
  if (distances) report.distances = write_distances(asked, clouds, *distances);
  if (!asked.scene.empty()) draw(report, robot, poses, clouds, distances ? &*distances : nullptr);
  shown.clear();
  say_notes(report.notes);
  std::cout << (asked.json ? to_json(report) : to_text(report));
  return exit_code(report);
}

subcommand add_query(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("query", "The least distance between a robot and what a sensor saw");
  return [options = add_query_options(*sub, asking::query)] {
    const query_options asked = options();
    return asked.shard ? on_all_ranks([&](all_ranks& ranks) { return run(asked, &ranks); }) : run(asked, nullptr);
  };
}

const listed_subcommand listed_query(0, add_query);

}  // namespace
