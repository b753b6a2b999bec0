// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What `query`, `run` and `plan` say about room that no camera sees.

#include "query_options.hpp"
#include "report_json.hpp"

#include <clearance/questions/unseen.hpp>

/// One answer of --unseen, with what it names.
struct unseen_report {
  const query_options* asked = nullptr;
  const clearance::unseen_result* found = nullptr;
  std::vector<const observation*> clouds;  // in the answer's order
  const std::vector<body>* bodies = nullptr;
  bool filtered = false;  // by --self-filter: then there is an own shadow to tell of

  /// Does --check pass?
  bool passes() const { return found->all.state != clearance::state::no_data && found->all.lower > *asked->margin; }
  const observation* cloud(std::uint32_t number) const { return number == clearance::none ? nullptr : clouds[number]; }
};

/// The answer about the robot, and about one part.
json unseen_of(const unseen_report& report);
json unseen_of(const unseen_report& report, std::size_t part);

/// The answer as text: a line or two, and a table of parts.
std::string unseen_text(const unseen_report& report);
std::string unseen_parts_text(const unseen_report& report);

/// The columns of a table about the robot, and their cells.
inline constexpr const char* unseen_columns =
    "unseen_state,unseen_distance,unseen_lower,unseen_part,unseen_pixel_x,unseen_pixel_y";
std::string unseen_cells(const unseen_report& report);
