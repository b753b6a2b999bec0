// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Instructions of a device that CUDA has no function for. They stand here alone, because a program that runs kernels on
// a CPU (tests/emulated) has a model of this file instead.

#include <clearance/ground/config.hpp>

#include <cstdint>

#if defined(__CUDACC__)
namespace clearance::ptx {

/// The square root of a number that is not negative, with a relative error of up to 2^-23.
__device__ inline float rough_root(float a) {
  float root;
  asm("sqrt.approx.ftz.f32 %0, %1;" : "=f"(root) : "f"(a));
  return root;
}

/// The inverse likewise. That of a subnormal number may be infinite.
__device__ inline float rough_inverse(float a) {
  float inverse;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(a));
  return inverse;
}

/// Adds one and returns the old value, in the order of the whole device: before it what this thread wrote before, after
/// it what it reads later.
__device__ inline std::uint32_t add_one_in_order(std::uint32_t& counter) {
  std::uint32_t old;
  asm volatile("atom.add.acq_rel.gpu.u32 %0,[%1],%2;" : "=r"(old) : "l"(&counter), "r"(1u) : "memory");
  return old;
}

/// Lets the next kernel of the stream start, and waits for what the stream has before this kernel. Nothing on devices
/// before Hopper.
__device__ inline void launch_dependents() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.launch_dependents;" ::: "memory");
#endif
}
__device__ inline void wait_for_dependencies() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.wait;" ::: "memory");
#endif
}

}  // namespace clearance::ptx
#endif
