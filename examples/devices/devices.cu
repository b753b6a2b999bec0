// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/device.cuh>

#include "devices.hpp"

int main() {
  // [devices]
  clearance::devices gpus = clearance::devices::all();
  if (gpus.size() == 1)
    gpus = clearance::devices{0, 0};  // one GPU may be named twice, so that a program can be tried anywhere
  const auto resident = clearance::shard(gpus, wall());  // a slice on each, for a cloud that stays
  const int wrong = example(gpus, wall()) + example(gpus, resident.view());
  // [devices]
  return wrong;
}
