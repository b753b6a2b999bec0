// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What `clearance query` reports besides the least distance: zones, nearest points, the self filter, support,
// gradients, and the cost of a deadline.

#include "query_report.hpp"
#include "report_json.hpp"

/// For a part: its zones, the innermost first; its nearest points; its gradient.
json zones_of(const query_report& report, std::size_t part);
json nearest_of(const query_report& report, std::size_t part);
json gradient_of(const query_report& report, std::size_t part);

/// For the whole robot: each answer becomes an object named after its question.
void add_questions(const query_report& report, json& out);

/// The answers as text: one line per question, and the text after the list of parts.
std::string questions_text(const query_report& report);
std::string parts_text(const query_report& report);
