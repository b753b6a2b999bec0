// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/backends/device.cuh>

#include "trees.hpp"

std::unique_ptr<backend_memory> memory_on_device(const asked_model& asked) {
  return std::make_unique<memory_on<clearance::device>>(clearance::device{}, asked);
}
