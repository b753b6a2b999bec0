// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target off("off", [](std::string_view input) { fuzz::read_mesh("m.off", input); });
