// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/backends/device.cuh>

#include "trees.hpp"

template auto robot_on_backend<clearance::device>::usual_trees() -> const trees&;

std::unique_ptr<backend_robot> robot_on_device(const asked_model& asked) {
  return std::make_unique<robot_on_backend<clearance::device>>(clearance::device{}, asked);
}
