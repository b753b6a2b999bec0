// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target xyz("xyz", [](std::string_view input) { fuzz::read_cloud("m.xyz", input); });
