// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "plan_report.hpp"
#include "unseen_report.hpp"

/// What `clearance run` reports about a frame.
struct frame_report {
  std::size_t frame = 0;  // from 0
  std::string file;
  reply found;
  const observation* cloud = nullptr;  // of the witness, whose number follows; null: no valid point
  std::uint32_t point = 0;
  const std::vector<body>* bodies = nullptr;
  double upload = 0, query = 0;              // seconds
  std::optional<unseen_report> unseen = {};  // for --unseen
  double unseen_query = 0;                   // seconds
  const plan_report* plan = nullptr;         // for --plan
};

/// One JSON object on one line.
std::string to_json(const frame_report& report);

/// One line of a table; before the first frame's, the column names.
std::string to_csv(const frame_report& report);
