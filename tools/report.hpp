// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "observations.hpp"
#include "robot_bodies.hpp"

/// All that `clearance query` has to say.
struct query_report {
  const query_options* asked = nullptr;
  const std::vector<observation>* clouds = nullptr;
  const std::vector<body>* bodies = nullptr;
  reply found;
  double load = 0, pack = 0;  // seconds
  std::vector<std::string> notes;
};

/// What `clearance run` has to say of a frame.
struct frame_report {
  std::size_t frame = 0;  // from 0
  std::string file;
  reply found;
  const observation* cloud = nullptr;  // the witness's, and its number there; null if there is no valid point
  std::uint32_t point = 0;
  const std::vector<body>* bodies = nullptr;
};

/// One JSON object in one line.
std::string to_json(const frame_report& report);

/// One JSON object, and a line end.
std::string to_json(const query_report& report);

/// For people.
std::string to_text(const query_report& report);
