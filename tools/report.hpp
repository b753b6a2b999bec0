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
  answer found;
  double load = 0, pack = 0;  // seconds
  std::vector<std::string> notes;
};

/// One JSON object, and a line end.
std::string to_json(const query_report& report);

/// For people.
std::string to_text(const query_report& report);
