// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Kernels that start while the one before them in their stream still runs: programmatic dependent launch.

namespace clearance {

/// Lets the next kernel of the stream start, if it may start early: as soon as all blocks have called this.
__device__ inline void let_next_start() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.launch_dependents;" ::: "memory");
#endif
}

/// Waits until all that is in the stream before this kernel has ended. Its writes are seen then. Code for devices
/// before Hopper does not wait, and such a kernel is not launched early.
__device__ inline void wait_for_stream() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.wait;" ::: "memory");
#endif
}

/// A kernel that is launched early begins with both. What it could do before it waits is not worth it: the first reads
/// of a frame that comes alone would begin later.
__device__ inline void start_early() { let_next_start(), wait_for_stream(); }

}  // namespace clearance
