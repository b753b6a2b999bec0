// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target ply_mesh("ply_mesh", [](std::string_view input) { fuzz::read_mesh("m.ply", input); });
