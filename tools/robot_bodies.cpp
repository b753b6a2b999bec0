// SPDX-License-Identifier: BSD-3-Clause
#include "robot_bodies.hpp"

#include "command_line.hpp"

using namespace clearance;

io::packing_cache chosen_cache(bool none, const std::string& folder) {
  if (none && !folder.empty()) throw usage_error("--no-cache", "cannot be mixed with --cache");
  if (none) return {};
  return io::packing_cache(folder.empty() ? io::packing_cache::usual_folder() : std::filesystem::path(folder));
}
