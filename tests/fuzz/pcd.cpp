// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target pcd("pcd", [](std::string_view input) { fuzz::read_cloud("m.pcd", input); });
