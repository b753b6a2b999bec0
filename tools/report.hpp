// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "asked_robot.hpp"
#include "backends.hpp"
#include "distances_file.hpp"
#include "observations.hpp"
#include "robot_bodies.hpp"

#include <clearance/gradient.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances.hpp>
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
  std::vector<part_gradient> gradients;  // of all parts; empty: not asked
  std::optional<distances_written> distances;
  double load = 0, pack = 0, build = 0, upload = 0, query = 0;  // seconds; query: for the least distance
  std::vector<std::string> notes;

  /// Is the lower end of the bracket above the margin of --check?
  bool passes() const { return found.result.state != clearance::state::no_data && found.result.lower > *asked->margin; }
};

/// What `clearance plan` reports, and `clearance run` about its plan: one result per configuration.
struct plan_report {
  const query_options* asked = nullptr;
  const std::vector<observation>* clouds = nullptr;
  const std::vector<body>* bodies = nullptr;
  clearance::min_distances_result found = {};
  std::vector<clearance::motion_clearance_result> ways = {};    // for --between: way k goes from row k to the next
  double load = 0, pack = 0, build = 0, upload = 0, query = 0;  // seconds

  /// The first configuration whose lower end is not above the margin of --check; without a valid point, the first one.
  std::optional<std::size_t> first_below() const;
  /// The first way that may come nearer than the margin.
  std::optional<std::size_t> first_way_below() const;
  bool blind() const { return found.of[0].state == clearance::state::no_data; }
  /// 3 without a valid point, 2 if --check fails.
  int code() const { return blind() ? 3 : asked->margin && (first_below() || first_way_below()) ? 2 : 0; }
};

/// What `clearance run` reports about a frame.
struct frame_report {
  std::size_t frame = 0;  // from 0
  std::string file;
  reply found;
  const observation* cloud = nullptr;  // of the witness, whose number follows; null: no valid point
  std::uint32_t point = 0;
  const std::vector<body>* bodies = nullptr;
  double upload = 0, query = 0;       // seconds
  const plan_report* plan = nullptr;  // for --plan
};

/// One JSON object on one line.
std::string to_json(const frame_report& report);

/// One line of a table; before the first frame's, the column names.
std::string to_csv(const frame_report& report);

/// One JSON object and a line end.
std::string to_json(const query_report& report);

/// As text for people.
std::string to_text(const query_report& report);

/// One JSON object per configuration, each on one line, and a last one about all.
std::string to_json(const plan_report& report);

/// A line of column names, and one line per configuration.
std::string to_csv(const plan_report& report);
