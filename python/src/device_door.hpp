// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the module _cuda hands to _core: functions that know devices, behind types that do not.

#include "asker.hpp"

#include <string>
#include <variant>
#include <vector>

using near_map_options = std::variant<clearance::field_options, clearance::cell_options>;

struct device_door {
  /// A robot's trees in a device's memory.
  std::shared_ptr<void> (*upload)(const robot_trees<>& trees, int device);
  /// The same trees with fields or cells, made on a device; for each part that has none, why.
  std::shared_ptr<const robot_trees<>> (*with_near_map)(const robot_trees<>& trees, const near_map_options& options,
                                                        std::vector<std::string>& without, int device);
  /// An asker<Q> for the question whose type has this name; nullptr if the module does not know it.
  void* (*prepare)(const char* type, const std::shared_ptr<void>& trees, const void* question, int device);
  /// Memory of a device, aligned for anything. Giving it back waits until nothing on the device can use it.
  std::shared_ptr<void> (*allocate)(std::size_t bytes, int device);
  /// What comes later in stream `then` waits for what is in stream `first` now.
  void (*order)(void* first, void* then, int device);
  /// Copies from pageable memory of the host, which may change when this returns; enqueued.
  void (*bring)(void* to, const void* from, std::size_t bytes, int device, void* stream);
  /// Copies to the host, and waits.
  void (*fetch)(void* to, const void* from, std::size_t bytes, int device, void* stream);
  void (*wait)(int device, void* stream);
  /// The device whose memory this is; -1: none's.
  int (*holder)(const void* memory);
};
