// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the questions of `clearance query` beside the least distance have to say: zones, nearest points, the self
// filter, support, gradients; and what a deadline has cost.

#include "report.hpp"
#include "report_json.hpp"

/// Of a part: its zones, the innermost first, its nearest points, and its gradient.
json zones_of(const query_report& report, std::size_t part);
json nearest_of(const query_report& report, std::size_t part);
json gradient_of(const query_report& report, std::size_t part);

/// x,y,z,qx,qy,qz,qw.
json pose_of(const Eigen::Isometry3d& pose);

/// Of the robot as a whole: what was asked goes to an object with the name of the question.
void add_questions(const query_report& report, json& out);

/// The same for people: a line for each question, and what follows the list of parts.
std::string questions_text(const query_report& report);
std::string parts_text(const query_report& report);
