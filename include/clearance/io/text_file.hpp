// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The text of a file as UTF-8. Windows tools save text as UTF-16, which begins with a byte order mark.

#include <clearance/io/error.hpp>

#include <string>

namespace clearance::io {

/// Text as UTF-8. UTF-16 with its mark is converted; UTF-16 without it, and UTF-32, are refused by name.
std::string as_utf8(std::string bytes, const std::string& file);

/// `read_bytes`, for a file of text.
std::string read_text(const std::string& file, const read_limits& limits = {});

}  // namespace clearance::io
