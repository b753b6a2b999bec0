// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the tables of `plan` and `run` share. A cell holds the value in JSON, or nothing for null.

#include "report_json.hpp"

/// A word of CSV (RFC 4180), empty for null. Infinities, which JSON lacks, are words in CSV.
std::string csv_word(const json& value, double number = 0);

/// The columns of a witness, and its cells.
inline constexpr const char* witness_columns =
    "state,distance,lower,upper,cloud,point,part,primitive,point_x,point_y,point_z,nearest_x,nearest_y,nearest_z";
std::string witness_cells(const clearance::min_distance_result& r, const observation* cloud, std::uint32_t point,
                          const std::vector<body>& bodies);
