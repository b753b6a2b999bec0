// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target spheres_yaml("spheres_yaml",
                                       [](std::string_view input) { fuzz::read_spheres("m.yaml", input); });
