// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The only way in which this library writes files: beside, then in place, so a full disk or a crash does no damage.

#include <clearance/io/error.hpp>

#include <sys/stat.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace clearance::io {

/// Refuses to replace a folder, device, pipe or symbolic link (should the file behind it be replaced?). Returns the
/// status of the present file, if there is one.
std::optional<struct ::stat> check_target(const std::string& file);

/// As write_bytes, for the pieces that `next()` returns, until one is empty.
void write_pieces(const std::string& file, const std::function<std::string()>& next);

/// Replaces the file's content completely or not at all. The bytes go to a new file beside it, reach the disk, and then
/// take its name and permissions. Throws std::runtime_error naming the file, which is then unchanged.
void write_bytes(const std::string& file, std::string_view bytes);

/// As check_target; also refuses a file that `inputs` has recorded.
void check_output(const std::string& file, const files_read& inputs);

}  // namespace clearance::io
