// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_sensor_messages(nb::module_& m);
