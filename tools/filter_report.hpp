// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// --self-filter, as `query` and `run` have it: what it hides, and what is said about that.

#include "asked_clouds.hpp"
#include "report_json.hpp"

#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/unseen.hpp>

/// What was asked before the points were hidden.
struct own_points {
  clearance::self_filter_result filter;
  std::optional<clearance::unseen_result> unseen;  // for --unseen, whose images still have the robot's pixels
  double unseen_query = 0, upload = 0;             // seconds
};

/// Hides the points that are the robot's own from the questions that follow.
own_points hide_own_points(const query_options& asked, backend_robot& there, poses_of poses, asked_clouds& clouds,
                           const std::vector<double>& radii);

/// Adds a note if a threshold is within --self-filter, which hides the points that it is about.
void note_hidden(const query_options& asked, std::vector<std::string>& notes);

/// `nearest`: the least distance to the points that are left.
json filter_of(const query_options& asked, const clearance::self_filter_result& filter,
               const clearance::min_distance_result& nearest);
std::string filter_text(const query_options& asked, const clearance::self_filter_result& filter,
                        const clearance::min_distance_result& nearest);
