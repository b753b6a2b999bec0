// SPDX-License-Identifier: BSD-3-Clause
// Replaces everything that nvcc compiles if there is no CUDA compiler.
#include "questions/asked.hpp"

#include <stdexcept>

namespace {

constexpr const char* without = "this clearance was built without CUDA";

}  // namespace

std::unique_ptr<backend_memory> memory_on_device(const asked_model&) { throw std::runtime_error(without); }

clearance::packing pack_on_device(const clearance::mesh_solid&, const clearance::pack_options&) {
  throw std::runtime_error(without);
}

device_state find_device() { return {false, false, without}; }
