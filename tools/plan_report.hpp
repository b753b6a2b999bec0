// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "observations.hpp"
#include "query_options.hpp"
#include "recording.hpp"
#include "report_json.hpp"
#include "unseen_report.hpp"

#include <clearance/motion_clearance.hpp>
#include <clearance/questions/min_distances.hpp>

/// What `clearance plan` reports, and `clearance run` about its plan: one result per configuration.
struct plan_report {
  const query_options* asked = nullptr;
  const std::vector<observation>* clouds = nullptr;
  const std::vector<body>* bodies = nullptr;
  clearance::min_distances_result found = {};
  std::vector<certain_row> certain = {};                        // of each, if something is uncertain
  std::vector<clearance::unseen_result> unseen = {};            // for --unseen: of each configuration
  std::vector<clearance::motion_clearance_result> ways = {};    // for --between: way k goes from row k to the next
  std::vector<clearance::motion_clearance_result> hidden = {};  // for both: the ways, about what the clouds hide
  std::size_t fields = 0, fields_cached = 0;                    // that were used, and how many of them the cache had
  double load = 0, pack = 0, build = 0, upload = 0, query = 0;  // seconds

  /// The first configuration whose lower end, of what is certain if that was asked, is not above the margin of --check;
  /// without a valid point, the first one.
  std::optional<std::size_t> first_below() const;
  /// The first way that may come nearer than the margin.
  std::optional<std::size_t> first_way_below() const;
  /// The first configuration that what is hidden may be nearer to than the margin, or as near.
  std::optional<std::size_t> first_hidden_below() const;
  /// The first way that may come nearer than the margin to what is hidden.
  std::optional<std::size_t> first_hidden_way_below() const;
  unseen_report of_unseen(std::size_t row) const;
  bool blind() const { return found.of[0].state == clearance::state::no_data; }
  /// 3 without a valid point, 2 if --check fails.
  int code() const {
    const bool below =
        asked->margin && (first_below() || first_way_below() || first_hidden_below() || first_hidden_way_below());
    return blind() ? 3 : below ? 2 : 0;
  }
};

/// The number of configurations, the least distance of all with its configuration, and, for --check, the first that
/// fails.
json outcome_of(const plan_report& report);

/// One JSON object per configuration, each on one line, and a last one about all.
std::string to_json(const plan_report& report);

/// A line of column names, and one line per configuration.
std::string to_csv(const plan_report& report);
