// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "certain_report.hpp"
#include "filter_report.hpp"
#include "plan_report.hpp"
#include "recording.hpp"
#include "unseen_report.hpp"

/// What `clearance run` reports about a frame.
struct frame_report {
  const query_options* asked = nullptr;
  std::size_t frame = 0;  // from 0
  std::string file;
  const stamped_row* stamped = nullptr;  // for --stamps
  reply found;
  const observation* cloud = nullptr;  // of the witness, whose number follows; null: no valid point
  std::uint32_t point = 0;
  const std::vector<body>* bodies = nullptr;
  double upload = 0, query = 0;                           // seconds
  const clearance::self_filter_result* filter = nullptr;  // for --self-filter
  std::optional<clearance::certain_distance_result> certain = {};
  std::optional<unseen_report> unseen = {};  // for --unseen
  double unseen_query = 0;                   // seconds
  const plan_report* plan = nullptr;         // for --plan

  /// Is there more to say about each part than about the robot?
  bool each_part() const { return asked->certain || asked->unseen; }
};

/// One JSON object on one line.
std::string to_json(const frame_report& report);

/// One line of a table; before the first frame's, the column names.
std::string to_csv(const frame_report& report);
