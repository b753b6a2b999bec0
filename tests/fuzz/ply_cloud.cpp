// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target ply_cloud("ply_cloud", [](std::string_view input) { fuzz::read_cloud("m.ply", input); });
