// SPDX-License-Identifier: BSD-3-Clause
// Stands for device.cu where there is no CUDA compiler.
#include "backends.hpp"

#include <stdexcept>

reply ask_device(const question&) { throw std::runtime_error("this clearance was built without CUDA"); }

std::unique_ptr<prepared_question> prepare_device(const question&) {
  throw std::runtime_error("this clearance was built without CUDA");
}

device_state find_device() { return {false, false, "this clearance was built without CUDA"}; }
