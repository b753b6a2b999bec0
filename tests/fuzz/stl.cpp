// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target stl("stl", [](std::string_view input) { fuzz::read_mesh("m.stl", input); });
