// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/packing_cache.hpp>

#include <string>
#include <vector>

/// Makes the folder in which packings are kept, if any. Where that cannot be, a folder that --cache names is refused;
/// else a note says that nothing is kept.
void check_kept(const clearance::io::packing_cache& cache, bool named, std::vector<std::string>& notes);
