// SPDX-License-Identifier: BSD-3-Clause
#include "asked_clouds.hpp"
#include "asked_robot.hpp"
#include "camera_checks.hpp"
#include "clearance_svg.hpp"
#include "command_line.hpp"
#include "filter_report.hpp"
#include "frame_report.hpp"
#include "messages.hpp"
#include "recording.hpp"
#include "scale_notes.hpp"

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
  struct ::stat present{};
  if (::stat(file.c_str(), &present) == 0) io::files_read::note({present.st_dev, present.st_ino});
}

void print(const std::vector<std::string>& notes, progress& shown) {
  shown.clear();
  say_notes(notes);
}

/// The robot along its trajectory, with the camera.
class motion {
 public:
  motion(const query_options& asked, const asked_robot& robot) : asked_(asked), robot_(robot) {
    if (asked.recording.stamps.empty())
      rows_ = read_rows(asked, robot.description, asked.recording.trajectory);
    else
      stamped_ = read_stamped_rows(asked, robot.description);
  }

  /// Refuses rows that are not as many as frames, unless there is one for all.
  void check(std::size_t frames) const {
    const recording_options& from = asked_.recording;
    if (!from.stamps.empty() && stamped_.size() != frames)
      throw usage_error("--stamps", from.stamps + " has " + std::to_string(stamped_.size()) + " lines, but there are " +
                                        std::to_string(frames) + " frames");
    if (from.stamps.empty() && rows_.size() != 1 && rows_.size() != frames)
      throw usage_error("--trajectory", from.trajectory + " has " + std::to_string(rows_.size()) +
                                            " rows, but there are " + std::to_string(frames) +
                                            " frames (one row would hold for all)");
  }

  const std::vector<double>& row(std::size_t frame) const {
    if (!stamped_.empty()) return stamped_[frame].joints.values;
    return rows_.size() == 1 ? rows_[0] : rows_[frame];
  }
  /// The row that --stamps gives a frame; or null.
  const stamped_row* stamped(std::size_t frame) const { return stamped_.empty() ? nullptr : &stamped_[frame]; }
  /// Seconds between the joints and the frame.
  double off(std::size_t frame) const { return stamped_.empty() ? 0 : stamped_[frame].joints.off; }

  /// One radius per part, by what is uncertain about the joints.
  std::vector<part_radius> radii(std::size_t frame, std::span<const part_facts> facts) const {
    return radii_of(asked_, robot_, row(frame), facts, off(frame));
  }
  std::vector<double> summed(std::size_t frame, std::span<const part_facts> facts) const {
    return summed_radii(asked_, robot_, row(frame), facts, off(frame));
  }
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
  const query_options& asked_;
  const asked_robot& robot_;
  std::vector<std::vector<double>> rows_;
  std::vector<stamped_row> stamped_;
};

/// The frames' files, which are read one at a time.
class frame_files {
 public:
  frame_files(const query_options& asked, progress& shown, std::vector<std::string>& notes)
      : asked_(asked.recording), shown_(shown) {
    for (const std::string& file : list_frames(asked_.frames, notes)) {
      files_.push_back(asked_.camera);
      files_.back().file = file;
      files_.back().check("--frames");
      if (asked.unseen) files_.back().check_hides();
    }
    check_all_clouds(asked_.camera, files_);
    check_image_sizes(files_);
  }

  std::size_t size() const { return files_.size(); }
  const std::string& operator[](std::size_t frame) const { return files_[frame].file; }

  observation load(std::size_t frame) {
    shown_.show("frame " + std::to_string(frame + 1) + '/' + std::to_string(size()));
    if (!asked_.merge) names_.clear();  // the line names its frame
    observation found = observe(files_[frame], names_);
    if (frame == 0) note_camera(found, found.notes);  // the others are as large
    print(found.notes, shown_);
    return found;
  }

 private:
  const recording_options& asked_;
  progress& shown_;
  std::vector<cloud_options> files_;
  std::set<std::string> names_;
};

/// Checks that the picture can be written, before any frame is read or answered.
void check_picture(const std::string& file, const frame_files& frames, const io::files_read& inputs) {
  for (std::size_t k = 0; k < frames.size(); ++k) note_file(frames[k]);
  io::check_output(file, inputs);
  const auto folder = std::filesystem::path(file).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    io::refuse(file, "cannot be written: there is no such folder");
}

/// The robot's waypoints for --plan; none without it.
class waypoints {
 public:
  waypoints(const query_options& asked, const asked_robot& robot) : asked_(asked), robot_(robot) {
    if (asked.recording.plan.empty()) return;
    rows_ = read_rows(asked, robot.description, asked.recording.plan);
    placed_.emplace(asked, robot, rows_, asked.recording.plan);
  }
  waypoints(const waypoints&) = delete;

  std::size_t size() const { return rows_.size(); }

  /// `clouds`: what the backend was shown last, unless they are merged.
  std::optional<plan_report> ask(backend_robot& there, const std::vector<observation>& clouds,
                                 const std::vector<body>& bodies) {
    if (!placed_) return std::nullopt;
    plan_report plan{.asked = &asked_, .clouds = &clouds, .bodies = &bodies};
    plan.found = ask_plan(there, *placed_, infinity, plan.query);
    if (asked_.certain) {
      if (!radii_) radii_ = radii_in_rows(asked_, robot_, rows_, there.facts());
      plan.certain = ask_certain_plan(there, *placed_, infinity, *radii_, plan.query);
    }
    if (asked_.unseen)
      plan.unseen =
          ask_plan_unseen(there, *placed_, {.room = *asked_.unseen, .radii = radii_.value_or(std::vector<double>())},
                          bodies.size(), true, plan.query);
    return plan;
  }

 private:
  const query_options& asked_;
  const asked_robot& robot_;
  std::vector<std::vector<double>> rows_;
  std::optional<placed_rows> placed_;
  std::optional<std::vector<double>> radii_;  // of the parts, in all rows
};

/// What is certain, as the picture draws it.
min_distance_result bracket_of(const certain_distance_result& certain) {
  min_distance_result r = certain.nominal;
  r.lower = certain.lower;
  r.upper = certain.upper;
  return r;
}

int exit_code(const frame_report& report, const std::optional<double>& margin) {
  const min_distance_result& r = report.found.result;
  const real lower = report.certain ? report.certain->lower : r.lower;
  const bool passes = !margin || (lower > *margin && (!report.unseen || report.unseen->passes()));
  const int least = r.state == state::no_data ? 3 : passes ? 0 : 2;
  return std::max(least, report.plan ? report.plan->code() : 0);
}

int run_frames(const query_options& asked) {
  progress shown;
  shown.show("reading " + asked.robot);
  io::files_read inputs;
  std::vector<std::string> notes;
  const asked_robot robot = load_robot(asked, notes);
  frame_files frames(asked, shown, notes);
  const motion moves(asked, robot);
  moves.check(frames.size());
  waypoints to_come(asked, robot);
  merged_cloud merged;
  if (asked.recording.merge)
    for (std::size_t k = 0; k < frames.size(); ++k) merged.add(frames.load(k), moves.carrier(k));
  else
    moves.carrier(0);  // refuse a wrong --camera-link before packing the robot

  note_hidden(asked, notes);
  if (!asked.recording.svg.empty()) check_picture(asked.recording.svg, frames, inputs);
  const field_use fields = uses_fields(asked, to_come.size() * frames.size());
  const std::vector<body> bodies = make_bodies(asked, robot, shown, notes, fields);
  print(notes, shown);
  const auto robot_there = robot_on(asked.on_device, {asked.model, asked.volume, &bodies, fields,
                                                      chosen_cache(asked.no_cache, asked.cache).folder()});

  int code = 0;
  double upload = 0;
  if (asked.recording.merge) {
    seen_points whole = merged.finish(moves.poses(0));
    whole.boxes = asked.where.seen_from(whole.pose);
    upload = robot_there->see({whole});
  }
  asked_clouds clouds;  // the frame's
  svg_frames drawn;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const std::vector<Eigen::Isometry3d> poses = moves.poses(k);
    const observation* frame = nullptr;
    if (!asked.recording.merge) {
      observation next = frames.load(k);
      clouds = {};
      clouds.files.push_back(std::move(next));
      clouds.place(asked, robot, moves.row(k), poses, moves.off(k));
      upload = robot_there->see(clouds.seen);
      frame = &clouds.files[0];
    }

    std::optional<own_points> own;
    if (asked.self_filter) {
      own = hide_own_points(asked, *robot_there, poses, clouds, moves.summed(k, robot_there->facts()));
      upload += own->upload;
    }

    frame_report report{
        .asked = &asked, .frame = k, .file = frames[k], .stamped = moves.stamped(k), .found = {}, .bodies = &bodies};
    report.found = report.each_part() ? robot_there->least_per_part(poses, 1) : robot_there->least(poses);
    report.upload = std::exchange(upload, 0);
    report.query = robot_there->query;
    if (own) report.filter = &own->filter;
    if (asked.certain) report.certain = robot_there->certain(poses, moves.radii(k, robot_there->facts()));

    std::optional<unseen_result> unseen;
    if (asked.unseen) {
      unseen = own ? std::move(own->unseen)
                   : robot_there->unseen(poses, {.room = *asked.unseen, .radii = moves.summed(k, robot_there->facts())},
                                         false);
      report.unseen_query = own ? own->unseen_query : robot_there->query;
      report.unseen = {
          .asked = &asked, .found = &*unseen, .clouds = {frame}, .bodies = &bodies, .filtered = own.has_value()};
    }

    const std::optional<plan_report> plan = to_come.ask(*robot_there, clouds.files, bodies);
    if (plan) report.plan = &*plan;
    if (k == 0) {
      notes.clear();
      if (frame) note_scale(clouds.seen, bodies, poses, report.found.result, notes);
      note_fields(*robot_there, bodies, notes);
      print(notes, shown);
    }

    min_distance_result& r = report.found.result;
    if (r.state != state::no_data)
      std::tie(report.cloud, report.point) =
          frame ? std::pair<const observation*, std::uint32_t>(frame, r.point) : merged.origin(r.point);
    frame ? frame->recount(r) : merged.recount(r);
    // At once and as a whole: who waits for it has it, and whoever interrupts a recording has no half of it.
    std::cout << (asked.csv ? to_csv(report) : to_json(report)) << std::flush;
    if (!std::cout) return code;  // main reports it
    if (!asked.recording.svg.empty()) {
      drawn.seen.push_back(r);
      if (report.certain) drawn.certain.push_back(bracket_of(*report.certain));
      if (unseen) drawn.unseen.push_back(unseen->all);
    }
    code = std::max(code, exit_code(report, asked.margin));
  }

  if (!asked.recording.svg.empty()) {
    io::check_output(asked.recording.svg, inputs);
    io::write_bytes(asked.recording.svg, clearance_svg(drawn, asked.recording.frames, asked.margin));
  }
  return code;
}

subcommand add_run(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("run", "The least distance in every frame of a recording");
  return [options = add_query_options(*sub, asking::run)] { return run_frames(options()); };
}

const listed_subcommand listed_run(1, add_run);

}  // namespace
