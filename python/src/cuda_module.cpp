// SPDX-License-Identifier: BSD-3-Clause
#include "device_door.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

const device_door& this_door();
std::string no_device();

NB_MODULE(_cuda, m) {
  m.def("door", [] { return nanobind::capsule(static_cast<const void*>(&this_door()), "clearance.device"); });
  m.def("no_device", &no_device, "Empty, or why no device can be used.");
}
