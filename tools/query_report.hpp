// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "asked_robot.hpp"
#include "backends.hpp"
#include "certain_report.hpp"
#include "distances_file.hpp"
#include "observations.hpp"
#include "robot_bodies.hpp"
#include "unseen_report.hpp"

#include <clearance/gradient.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/zones.hpp>

/// How a part's least distance changes with its twist, and with the robot's joints (unknown if the first is).
struct part_gradient {
  clearance::pose_gradient of_pose;
  std::optional<Eigen::VectorXd> of_joints;
};

/// Everything that `clearance query` reports.
struct query_report {
  const query_options* asked = nullptr;
  const std::vector<observation>* clouds = nullptr;
  const std::vector<body>* bodies = nullptr;
  const asked_robot* robot = nullptr;
  reply found;
  std::optional<clearance::self_filter_result> filter;
  std::optional<clearance::zones_result> zones;
  std::optional<clearance::nearest_k_result> nearest;
  std::optional<clearance::supported_distance> support;
  std::optional<clearance::certain_distance_result> certain;
  std::optional<clearance::unseen_result> unseen;
  std::vector<part_gradient> gradients;  // of all parts; empty: not asked
  std::optional<distances_written> distances;
  std::size_t cells = 0, cells_bytes = 0;                       // as backend_robot says
  double load = 0, pack = 0, build = 0, upload = 0, query = 0;  // seconds; query: for the least distance
  std::vector<std::string> notes;

  std::vector<const observation*> all_clouds() const {
    std::vector<const observation*> listed;
    for (const observation& cloud : *clouds) listed.push_back(&cloud);
    return listed;
  }
  /// Is the lower end of the bracket above the margin of --check? With uncertainty, that of what is certain.
  bool passes() const {
    const clearance::real lower = certain ? certain->lower : found.result.lower;
    return found.result.state != clearance::state::no_data && lower > *asked->margin;
  }
  unseen_report of_unseen() const {
    return {
        .asked = asked, .found = &*unseen, .clouds = all_clouds(), .bodies = bodies, .filtered = filter.has_value()};
  }
};
