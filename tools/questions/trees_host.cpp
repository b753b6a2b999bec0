// SPDX-License-Identifier: BSD-3-Clause
#include "trees.hpp"

std::unique_ptr<backend_memory> memory_on_host(const asked_model& asked) {
  return std::make_unique<memory_on<clearance::host>>(clearance::host{}, asked);
}
