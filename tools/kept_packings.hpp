// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/packing_cache.hpp>

#include <string>
#include <vector>

/// Creates the folder for packings and fields, if there is to be one. If that fails, a folder named by --cache is
/// refused; for any other a note says that nothing is kept.
void check_kept(const clearance::io::packing_cache& cache, bool named, std::vector<std::string>& notes);
