// SPDX-License-Identifier: BSD-3-Clause
#include "kept_packings.hpp"

#include "command_line.hpp"

#include <unistd.h>

using namespace clearance;

void check_kept(const io::packing_cache& cache, bool named, std::vector<std::string>& notes) {
  if (cache.folder().empty()) return;
  std::error_code failed, unknown;
  std::filesystem::create_directories(cache.folder(), failed);
  const std::string folder = cache.folder().string();
  const bool is_folder = std::filesystem::is_directory(cache.folder(), unknown);
  if (named && !is_folder)
    throw usage_error(
        "--cache", folder + " is no folder, and none can be made: " + (failed ? failed.message() : unknown.message()));
  if (!is_folder || ::access(folder.c_str(), W_OK | X_OK) != 0)
    notes.push_back(folder +
                    ": cannot be written to, so nothing new is kept (--cache names another folder, --no-cache none)");
}
