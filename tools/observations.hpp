// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "query_options.hpp"

#include <clearance/io/cloud.hpp>
#include <clearance/io/depth.hpp>
#include <clearance/points/masked.hpp>

#include <map>
#include <set>
#include <string>
#include <variant>

/// One loaded --cloud.
struct observation {
  cloud_options from;
  std::string name;  // in the answer: that of the file; "c.xyz (2)" where it is there again
  std::variant<clearance::io::cloud, clearance::io::depth_frame> data;
  std::uint64_t zeros = 0;  // records that are (0,0,0) and were taken for missing, so that they are NaN in `data`
  std::vector<std::string> notes;

  std::uint64_t size() const;
  const clearance::io::cloud* points() const { return std::get_if<clearance::io::cloud>(&data); }
  const clearance::io::depth_frame* image() const { return std::get_if<clearance::io::depth_frame>(&data); }

  /// World-from-cloud. `carrier`: world-from-link of the link that --camera-link names, else the identity.
  Eigen::Isometry3d world(const Eigen::Isometry3d& carrier) const;

  /// What the query reads, in memory of this object; `robot`: where the parts will be, roughly, so that floats are fine
  /// there.
  seen_points seen(const Eigen::Isometry3d& carrier, poses_of robot);

  /// Where its points of numbers begin to end - 1 are in the world; of those that do not count, anywhere. `seen`: what
  /// seen(carrier, ...) gave.
  std::vector<Eigen::Vector3d> in_world(const Eigen::Isometry3d& carrier, const seen_points& seen, std::size_t begin,
                                        std::size_t end) const;

  /// Takes points out of what seen() gave: those that are labelled as the robot's own. Where they were, in that frame.
  std::vector<clearance::vec3> hide(std::span<const clearance::point_label> labels, const seen_points& seen);

  /// Counts what was turned into NaN as missing, and what was hidden as masked.
  void recount(clearance::min_distance_result& r) const;

  /// Frees the memory of points and pixels.
  void forget_points();

 private:
  clearance::io::float_cloud floats_;
  std::uint64_t hidden_ = 0;
};

/// Reads the file. Throws if it is damaged. `taken`: the names of others, and of this one afterwards.
observation observe(const cloud_options& from, std::set<std::string>& taken);
