// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Copies to shared memory that go on while a thread does other things: at once, or when they are waited for.

#include <cuda_runtime.h>

inline void __pipeline_memcpy_async(void* to, const void* from, std::size_t bytes) {
  emulated::copy_later(to, from, bytes);
}
inline void __pipeline_commit() { emulated::end_of_copies(); }
inline void __pipeline_wait_prior(unsigned but_last) { emulated::wait_for_copies(but_last); }
