// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

static const fuzz::target spheres_csv("spheres_csv",
                                      [](std::string_view input) { fuzz::read_spheres("m.csv", input); });
