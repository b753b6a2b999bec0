// SPDX-License-Identifier: BSD-3-Clause
#include "asked_robot.hpp"
#include "clearance_svg.hpp"
#include "command_line.hpp"
#include "messages.hpp"
#include "recording.hpp"
#include "report.hpp"

#include <clearance/io/write_file.hpp>

#include <CLI/CLI.hpp>

#include <sys/stat.h>

#include <filesystem>
#include <iostream>
#include <set>

using namespace clearance;

namespace {

/// Records a file that will be read, and so must not be written.
void note_file(const std::string& file) {
  struct ::stat there{};
  if (::stat(file.c_str(), &there) == 0) io::files_read::note({there.st_dev, there.st_ino});
}

void print(const std::vector<std::string>& notes, progress& shown) {
  shown.clear();
  say_notes(notes);
}

/// The robot along its trajectory, with the camera.
class motion {
 public:
  motion(const query_options& asked, const asked_robot& robot)
      : asked_(asked), robot_(robot), rows_(read_rows(asked, robot.description, asked.recording.trajectory)) {}

  std::size_t size() const { return rows_.size(); }

  std::vector<Eigen::Isometry3d> poses(std::size_t frame) const {
    return placed_links(asked_, robot_, row(frame), " in frame " + std::to_string(frame));
  }
  Eigen::Isometry3d carrier(std::size_t frame) const {
    const std::string& link = asked_.recording.camera.link;
    if (link.empty()) return Eigen::Isometry3d::Identity();
    return about_file(asked_.robot, [&] {
      return io::carried(asked_.base, robot_.description.link_pose(link, row(frame), {asked_.ignore_limits}),
                         "link " + io::quoted(link));
    });
  }

 private:
  const std::vector<double>& row(std::size_t frame) const { return rows_.size() == 1 ? rows_[0] : rows_[frame]; }

  const query_options& asked_;
  const asked_robot& robot_;
  std::vector<std::vector<double>> rows_;
};

std::vector<cloud_options> frames_of(const query_options& asked) {
  std::vector<cloud_options> frames;
  for (const std::string& file : list_frames(asked.recording.frames)) {
    frames.push_back(asked.recording.camera);
    frames.back().file = file;
    frames.back().check("--frames");
  }
  check_all_clouds(asked.recording.camera, frames);
  return frames;
}

/// Checks that the picture can be written, before any frame is read or answered.
void check_picture(const std::string& file, const std::vector<cloud_options>& frames, const io::files_read& inputs) {
  for (const cloud_options& each : frames) note_file(each.file);
  io::check_output(file, inputs);
  const auto folder = std::filesystem::path(file).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    io::refuse(file, "cannot be written: there is no such folder");
}

int run_frames(const query_options& asked) {
  progress shown;
  shown.show("reading " + asked.robot);
  io::files_read inputs;
  std::vector<std::string> notes;
  const asked_robot robot = load_robot(asked, notes);
  const std::vector<cloud_options> frames = frames_of(asked);
  const motion moves(asked, robot);
  if (moves.size() != 1 && moves.size() != frames.size())
    throw usage_error("--trajectory", asked.recording.trajectory + " has " + std::to_string(moves.size()) +
                                          " rows, but there are " + std::to_string(frames.size()) +
                                          " frames (one row would hold for all)");
  std::vector<std::vector<double>> to_come;
  std::optional<placed_rows> waypoints;
  if (!asked.recording.plan.empty()) {
    to_come = read_rows(asked, robot.description, asked.recording.plan);
    waypoints.emplace(asked, robot, to_come, asked.recording.plan);
  }
  std::set<std::string> names;
  const auto load = [&](std::size_t k) {
    shown.show("frame " + std::to_string(k + 1) + '/' + std::to_string(frames.size()));
    if (!asked.recording.merge) names.clear();  // the line names its frame
    observation frame = observe(frames[k], names);
    print(frame.notes, shown);
    return frame;
  };
  merged_cloud merged;
  if (asked.recording.merge)
    for (std::size_t k = 0; k < frames.size(); ++k) merged.add(load(k), moves.carrier(k));
  else
    moves.carrier(0);  // refuse a wrong --camera-link before packing the robot

  if (!asked.recording.svg.empty()) check_picture(asked.recording.svg, frames, inputs);
  const std::vector<body> bodies = make_bodies(asked, robot, shown, notes);
  print(notes, shown);
  const auto there = robot_on(asked.on_device, {asked.model, asked.volume, &bodies});
  int code = 0;
  double upload = asked.recording.merge ? there->see({merged.finish(moves.poses(0))}) : 0;
  std::optional<observation> frame;
  std::vector<min_distance_result> seen;  // for the picture
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (!asked.recording.merge) {
      observation next = load(k);
      frame.emplace(std::move(next));  // it must outlive the question
      upload = there->see({about_file(frames[k].file, [&] {
        const seen_points seen = frame->seen(moves.carrier(k), moves.poses(k));
        rigid(seen.pose, "cloud");
        return seen;
      })});
    }
    frame_report report{.frame = k, .file = frames[k].file, .found = there->least(moves.poses(k)), .bodies = &bodies};
    report.upload = std::exchange(upload, 0);
    report.query = there->query;
    plan_report plan{.asked = &asked};
    if (waypoints) {
      plan.found = ask_plan(*there, *waypoints, infinity, plan.query);
      report.plan = &plan;
    }
    min_distance_result& r = report.found.result;
    if (r.state != state::no_data)
      std::tie(report.cloud, report.point) =
          frame ? std::pair<const observation*, std::uint32_t>(&*frame, r.point) : merged.origin(r.point);
    frame ? frame->recount(r) : merged.recount(r);
    std::cout << (asked.csv ? to_csv(report) : to_json(report));
    if (!std::cout) return code;  // main reports it
    if (!asked.recording.svg.empty()) seen.push_back(r);
    const int each = r.state == state::no_data ? 3 : asked.margin && !(r.lower > *asked.margin) ? 2 : 0;
    code = std::max({code, each, report.plan ? plan.code() : 0});
  }
  if (!asked.recording.svg.empty()) {
    io::check_output(asked.recording.svg, inputs);
    io::write_bytes(asked.recording.svg, clearance_svg(seen, asked.recording.frames, asked.margin));
  }
  return code;
}

}  // namespace

subcommand add_run(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("run", "The least distance in every frame of a recording");
  return [options = add_query_options(*sub, asking::run)] { return run_frames(options()); };
}
