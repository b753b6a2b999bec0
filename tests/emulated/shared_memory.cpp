// SPDX-License-Identifier: BSD-3-Clause
#include "emulated/shared_memory.hpp"

#include <cstring>
#include <initializer_list>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(memory, bytes) static_cast<void>(0)
#define ASAN_UNPOISON_MEMORY_REGION(memory, bytes) static_cast<void>(0)
#endif

// The names that kernels use, each in its namespace. A kernel has one of them.
namespace clearance::scan {
alignas(128) thread_local std::byte scan_memory[emulated::most_shared];
}
namespace clearance::plan {
alignas(128) thread_local unsigned long long memory[emulated::most_shared / sizeof(unsigned long long)];
}

namespace emulated {

namespace {
template <class F>
void each(F f) {
  for (void* const memory : std::initializer_list<void*>{clearance::scan::scan_memory, clearance::plan::memory})
    f(static_cast<std::byte*>(memory));
}
}  // namespace

void empty_shared_memory([[maybe_unused]] std::size_t bytes) {
  each([bytes](std::byte* memory) {
    std::memset(memory, 0xcd, bytes);
    ASAN_POISON_MEMORY_REGION(memory + bytes, most_shared - bytes);
  });
}
void open_shared_memory() {
  each([]([[maybe_unused]] std::byte* memory) { ASAN_UNPOISON_MEMORY_REGION(memory, most_shared); });
}

}  // namespace emulated
