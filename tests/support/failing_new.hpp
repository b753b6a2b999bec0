// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An operator new that fails where a test wants it to, and counts. Include it in one source of a program.

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace testing {

/// Which allocations fail: those numbered `first` to `last`, of all threads.
struct failing_allocations {
  static constexpr std::size_t none = ~std::size_t(0);
  std::atomic<std::size_t> number = 0, first = none, last = none;
  std::atomic<std::ptrdiff_t> living = 0;  ///< Allocations that were not freed.

  bool fails() {
    const std::size_t mine = number.fetch_add(1);
    return first <= mine && mine <= last;
  }
};
inline failing_allocations allocations;

/// Where memory ends: at allocation k alone, or for good.
struct end_of_memory {
  std::size_t k;
  bool for_good, reached = false;

  /// Calls `work()`, which has no memory beyond. False if it threw std::bad_alloc.
  template <class Work>
  bool during(const Work& work) {
    const auto count_from_here = [](std::size_t first, std::size_t last) {
      allocations.first = failing_allocations::none, allocations.number = 0;
      allocations.last = last, allocations.first = first;
    };
    bool done = true;
    count_from_here(k, for_good ? failing_allocations::none - 1 : k);
    try {
      work();
    } catch (const std::bad_alloc&) {
      done = false;
    } catch (...) {
      reached = allocations.number > k;
      count_from_here(failing_allocations::none, failing_allocations::none);
      throw;
    }
    reached = allocations.number > k;
    count_from_here(failing_allocations::none, failing_allocations::none);
    return done;
  }
};

/// Calls `attempt(end)` for every place where memory can end, until it is not reached. `lost(k)` is called if an
/// attempt has not freed all that it allocated. Returns how many places there were.
template <class Attempt, class Lost>
std::size_t end_memory_everywhere(const Attempt& attempt, const Lost& lost) {
  std::size_t places = 0;
  for (const bool for_good : {false, true})
    for (end_of_memory end{0, for_good};; ++end.k, ++places) {
      const auto keeps = [&] {
        end.reached = false;
        const std::ptrdiff_t before = allocations.living;
        attempt(end);
        return allocations.living != before;
      };
      // A library keeps something from the first time on that two threads meet in it; what is lost is lost again.
      if (keeps() && keeps()) lost(end.k);
      if (!end.reached) break;
    }
  return places;
}

}  // namespace testing

#if !defined(__CUDA_ARCH__)  // nvcc would have these on a device, too
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (testing::allocations.fails()) throw std::bad_alloc();
  void* p = std::malloc(size == 0 ? 1 : size);
  if (!p) throw std::bad_alloc();
  ++testing::allocations.living;
  return p;
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  if (testing::allocations.fails()) throw std::bad_alloc();
  const std::size_t a = std::size_t(alignment);
  void* p = std::aligned_alloc(a, (size + a - 1) / a * a);
  if (!p) throw std::bad_alloc();
  ++testing::allocations.living;
  return p;
}
// A sanitizer has this one of its own, whose memory std::free would not take.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  if (p) --testing::allocations.living;
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { operator delete(p); }
[[gnu::noinline]] void operator delete(void* p, const std::nothrow_t&) noexcept { operator delete(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { operator delete(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept { operator delete(p); }
#endif
