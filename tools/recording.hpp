// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The recording of `clearance run`: the files of its frames, and the robot's configuration in each.

#include "asked_robot.hpp"
#include "observations.hpp"

#include <clearance/io/stamped_joints.hpp>

#include <map>
#include <string>
#include <vector>

/// The frames in a folder, by name and by the numbers in their names (9 before 10); those listed in a text file,
/// relative to it; or one that is a frame itself. At least one. A note says what is left out.
std::vector<std::string> list_frames(const std::string& where, std::vector<std::string>& notes);

/// The joints that the command line names: of --joint, and of the columns of all files of joints.
std::vector<std::string> joints_named(const query_options& asked);

/// One configuration per row. Every movable joint has a column or a value in `fixed`. If all are fixed, there is one
/// row, and the file has no columns or no name (empty). `times`: one for each row, of a column named time.
std::vector<std::vector<double>> read_trajectory(const std::string& file, const clearance::io::kinematic_tree& tree,
                                                 const std::map<std::string, double>& fixed,
                                                 clearance::io::joint_options limits,
                                                 std::vector<double>* times = nullptr);

/// `read_trajectory` for the given options, including --joint.
std::vector<std::vector<double>> read_rows(const query_options& asked, const clearance::io::robot& robot,
                                           const std::string& file);

/// When a frame was seen, and the configuration at that time.
struct stamped_row {
  double stamp;  // seconds
  clearance::io::stamped_joints::moment joints;
};

/// For --stamps: one row for each frame. Refuses frames about whose time the trajectory says too little.
std::vector<stamped_row> read_stamped_rows(const query_options& asked, const clearance::io::robot& robot);

/// The parts' poses in each row of a file, in blocks that fit into memory. All arguments must outlive it.
class placed_rows {
 public:
  placed_rows(const query_options& asked, const asked_robot& robot, const std::vector<std::vector<double>>& rows,
              const std::string& file);

  /// The poses of the first block, which is nearly always the only one.
  poses_of first() const { return first_; }

  /// Calls `ask(poses)` for each block.
  template <class Ask>
  void for_each_block(Ask ask) const {
    ask(poses_of(first_));
    for (std::size_t begin = rows_each_; begin < rows_.size(); begin += rows_each_) ask(poses_of(placed(begin)));
  }

 private:
  std::vector<Eigen::Isometry3d> placed(std::size_t begin) const;

  const query_options& asked_;
  const asked_robot& robot_;
  const std::vector<std::vector<double>>& rows_;
  std::string file_;
  std::size_t rows_each_;
  std::vector<Eigen::Isometry3d> first_;
};

/// Says of which bodies no field could be sampled.
void note_fields(const backend_robot& there, const std::vector<body>& bodies, std::vector<std::string>& notes);

/// Asks about all rows; adds the seconds to `query`.
clearance::min_distances_result ask_plan(backend_robot& there, const placed_rows& rows, double d_max, double& query);
/// What is certain of a row: that no point is nearer than `lower`, in metres, which `part` and that point keep down.
struct certain_row {
  clearance::state state = clearance::state::no_data;  // free, possible or no_data
  clearance::real lower = 0;
  std::uint32_t part = clearance::none, cloud = clearance::none, point = clearance::none;
  std::uint64_t anywhere = 0;  // points that may be anywhere
};
/// What is certain of all rows, about all places where points and parts may be.
std::vector<certain_row> ask_certain_plan(backend_robot& there, const placed_rows& rows, double d_max,
                                          const std::vector<double>& radii, double& query);
/// How far each row, of so many links, is from what the clouds hide (`until_end`: or may hide until the plan ends);
/// nothing about single links.
std::vector<clearance::unseen_result> ask_plan_unseen(backend_robot& there, const placed_rows& rows,
                                                      const clearance::unseen& q, std::size_t links, bool until_end,
                                                      double& query);

/// The clouds of many frames as one, in the world. Invalid points keep their places as NaN.
class merged_cloud {
 public:
  /// Adds the points of `frame`, which may go afterwards.
  void add(observation frame, const Eigen::Isometry3d& carrier);

  /// Call this once, after the last frame; `robot` as in observation::seen.
  seen_points finish(const std::vector<Eigen::Isometry3d>& robot);

  /// The frame in which point `i` of the merged cloud was seen, and the point's number there.
  std::pair<const observation*, std::uint32_t> origin(std::uint32_t i) const;

  /// Counts invalid points by the reasons in their own frames.
  void recount(clearance::min_distance_result& r) const;

 private:
  std::vector<observation> frames_;  // without their points
  std::vector<std::size_t> first_;   // the number of each frame's first point
  struct sensor {
    Eigen::Vector3d at;  // in the world
    double relative;     // a point's possible error, as a part of its distance from `at`
  };
  std::vector<sensor> sensors_;
  std::vector<Eigen::Vector3d> points_;
  std::uint64_t dropped_[clearance::drop_reasons] = {};
  clearance::io::float_cloud cloud_;
};
