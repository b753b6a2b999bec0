// SPDX-License-Identifier: BSD-3-Clause
#include "trees.hpp"

template auto robot_on_backend<clearance::host>::usual_trees() -> const trees&;

std::unique_ptr<backend_robot> robot_on_host(const asked_model& asked) {
  return std::make_unique<robot_on_backend<clearance::host>>(clearance::host{}, asked);
}
