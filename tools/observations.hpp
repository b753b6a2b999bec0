// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "query_options.hpp"

#include <clearance/io/cloud.hpp>
#include <clearance/io/png.hpp>
#include <clearance/points/masked.hpp>

#include <map>
#include <set>
#include <string>
#include <variant>

/// One loaded --cloud.
struct observation {
  cloud_options from;
  std::string name;  // its name in the answer: the file's; "c.xyz (2)" if it repeats
  std::variant<clearance::io::cloud, clearance::io::depth_frame> data;
  std::uint64_t zeros = 0;  // records at (0,0,0) that count as missing, so that they are NaN in `data`
  std::vector<std::string> notes;

  std::uint64_t size() const;
  const clearance::io::cloud* points() const { return std::get_if<clearance::io::cloud>(&data); }
  const clearance::io::depth_frame* image() const { return std::get_if<clearance::io::depth_frame>(&data); }

  /// World-from-cloud. `carrier`: world-from-link for the link of --camera-link, otherwise the identity.
  Eigen::Isometry3d world(const Eigen::Isometry3d& carrier) const;

  /// What the query reads, in this object's memory. `robot`: roughly where the parts will be, because floats are
  /// precise near there.
  seen_points seen(const Eigen::Isometry3d& carrier, poses_of robot);

  /// World positions of its points `begin` to end - 1; arbitrary for points that are not valid. `seen`: the return
  /// value of seen(carrier, ...).
  std::vector<Eigen::Vector3d> in_world(const Eigen::Isometry3d& carrier, const seen_points& seen, std::size_t begin,
                                        std::size_t end) const;

  /// Removes points that are labelled as the robot's own from what seen() gave. Returns where they were, in that frame.
  std::vector<clearance::vec3> hide(std::span<const clearance::point_label> labels, const seen_points& seen);

  /// Counts points that became NaN as missing, and hidden ones as masked.
  void recount(clearance::min_distance_result& r) const;

  /// Frees the memory of points or pixels.
  void forget_points();

 private:
  clearance::io::float_cloud floats_;
  std::uint64_t hidden_ = 0;
};

/// Reads the file. Throws if it is damaged. `taken`: the names in use, to which this one is added.
observation observe(const cloud_options& from, std::set<std::string>& taken);
