// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the library's header of this name does in PTX. Rough results are as rough as they may be.

#include <clearance/ground/config.hpp>

#include <cuda_runtime.h>

namespace clearance::ptx {

/// Off by up to 2^-23, as the schedule chooses.
inline float roughly(float exact) {
  const int off = int(emulated::chance() % 3) - 1;
  return off == 0 || !(exact > 0) || std::isinf(exact) ? exact : std::nextafterf(exact, off < 0 ? 0 : 2 * exact);
}
inline float without_subnormals(float a) { return std::fpclassify(a) == FP_SUBNORMAL ? std::copysign(0.0f, a) : a; }

inline float rough_root(float a) { return without_subnormals(roughly(std::sqrt(without_subnormals(a)))); }
inline float rough_inverse(float a) {
  const float inverse = 1 / without_subnormals(a);
  return without_subnormals(inverse < 0 ? -roughly(-inverse) : roughly(inverse));
}
inline std::uint32_t add_one_in_order(std::uint32_t& counter) { return atomicAdd(&counter, 1u); }
inline void launch_dependents() {}
inline void wait_for_dependencies() {}

}  // namespace clearance::ptx
