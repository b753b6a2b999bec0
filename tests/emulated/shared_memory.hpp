// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What kernels declare as `extern __shared__`, of this thread's block.

#include <cstddef>

namespace emulated {

inline constexpr std::size_t most_shared = 227 << 10;

/// Before a block: fills `bytes` with rubbish, and lets the AddressSanitizer refuse the rest. After it: takes that
/// back.
void empty_shared_memory(std::size_t bytes);
void open_shared_memory();

}  // namespace emulated
