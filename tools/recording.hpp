// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What `clearance run` plays: the files of its frames and the robot's configuration in each.

#include "asked_robot.hpp"
#include "observations.hpp"

#include <map>
#include <string>
#include <vector>

/// The frames of a folder in the order of their names, or those that a text file lists, relative to it. At least one.
std::vector<std::string> list_frames(const std::string& where);

/// One configuration a row. Every movable joint has either a column or a value in `fixed`; if all are fixed, there is
/// one row, and no file (an empty name) or one without columns.
std::vector<std::vector<double>> read_trajectory(const std::string& file, const clearance::io::kinematic_tree& tree,
                                                 const std::map<std::string, double>& fixed,
                                                 clearance::io::joint_options limits);

/// The same of what is asked, --joint among it.
std::vector<std::vector<double>> read_rows(const query_options& asked, const clearance::io::robot& robot,
                                           const std::string& file);

/// The parts' poses in one row of a file after another, in blocks that memory has room for. All that is given must
/// stay.
class placed_rows {
 public:
  placed_rows(const query_options& asked, const asked_robot& robot, const std::vector<std::vector<double>>& rows,
              const std::string& file);

  /// Of the first block, and so nearly always all.
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

/// Asks about all of them; seconds are added to `query`.
clearance::min_distances_result ask_plan(backend_robot& there, const placed_rows& rows, double d_max, double& query);

/// The clouds of many frames as one, in the world. Points that do not count keep their places, as NaN.
class merged_cloud {
 public:
  /// Adds what `frame` shows, which needs not stay.
  void add(observation frame, const Eigen::Isometry3d& carrier);

  /// To be called once, after the last frame; `robot` as of observation::seen.
  seen_points finish(const std::vector<Eigen::Isometry3d>& robot);

  /// The frame in which point `i` of the merged cloud was seen, and the point's number there.
  std::pair<const observation*, std::uint32_t> origin(std::uint32_t i) const;

  /// Counts the points that do not count by why they did not in their frames.
  void recount(clearance::min_distance_result& r) const;

 private:
  std::vector<observation> frames_;  // without their points
  std::vector<std::size_t> first_;   // the number of each frame's first point
  struct sensor {
    Eigen::Vector3d at;  // in the world
    double relative;     // how far a point may be off, as a part of its distance from there
  };
  std::vector<sensor> sensors_;
  std::vector<Eigen::Vector3d> points_;
  std::uint64_t dropped_[clearance::drop_reasons] = {};
  clearance::io::float_cloud cloud_;
};
