// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

void bind_self_distance(nanobind::module_& m);
