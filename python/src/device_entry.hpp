// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The module _cuda is imported when a device is first asked for.

#include "device_door.hpp"
#include "robot.hpp"

#include <typeinfo>

/// Throws what `clearance._device.door()` raises: a sentence that says why there is no device.
inline const device_door& open_device_door() {
  static const device_door* door = nullptr;
  if (door) return *door;
  const nb::gil_scoped_acquire python;
  const nb::object made = nb::module_::import_("clearance._device").attr("door")();
  door = static_cast<const device_door*>(PyCapsule_GetPointer(made.ptr(), "clearance.device"));
  if (!door) throw nb::python_error();
  return *door;
}

template <class Q>
std::unique_ptr<asker<Q>> ask_on_device(robot_model& robot, const Q& question, int device) {
  const device_door& door = open_device_door();
  std::shared_ptr<void> trees;
  {
    const std::scoped_lock lock(robot.devices);
    std::shared_ptr<void>& kept = robot.on_device[device];
    if (!kept) kept = door.upload(*robot.trees, device);
    trees = kept;
  }
  auto* const made = static_cast<asker<Q>*>(door.prepare(typeid(Q).name(), trees, &question, device));
  if (!made) throw std::runtime_error("clearance: the GPU part of this build does not know this question");
  return std::unique_ptr<asker<Q>>(made);
}
