// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

/// JSON as the command prints it: ASCII, with U+FFFD for bytes that are not UTF-8, and a line end. Indent -1: one line.
inline std::string json_text(const nlohmann::ordered_json& value, int indent) {
  return value.dump(indent, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

/// A number, or null: JSON cannot hold infinity and NaN.
inline nlohmann::ordered_json or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}
