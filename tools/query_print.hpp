// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "query_report.hpp"

/// One JSON object and a line end.
std::string to_json(const query_report& report);

/// The report as text for people.
std::string to_text(const query_report& report);
