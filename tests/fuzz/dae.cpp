// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target dae("dae", [](std::string_view input) { fuzz::read_mesh("m.dae", input); }, fuzz::damage_xml);
