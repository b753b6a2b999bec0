// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the module _cuda hands to _core: functions that know devices, behind types that do not.

#include "asker.hpp"

struct device_door {
  /// A robot's trees in a device's memory.
  std::shared_ptr<void> (*upload)(const robot_trees<>& trees, int device);
  /// An asker<Q> for the question whose type has this name; nullptr if the module does not know it.
  void* (*prepare)(const char* type, const std::shared_ptr<void>& trees, const void* question, int device);
};
