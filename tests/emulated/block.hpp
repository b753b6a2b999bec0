// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A block of a kernel on a CPU: a fiber for each thread, barriers that wait, and a schedule that a seed chooses. Blocks
// have a thread of the host each, of which one runs at a time. So `__shared__` is thread_local, and a run repeats to
// the bit.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace emulated {

/// Chooses who runs next, from now on. 0: threads in their order, blocks one after another.
void schedule(unsigned seed);
/// A number of the schedule's; 0 if the seed is 0.
std::uint32_t chance();

/// Runs `body()` once for each thread of each block. Returns what went wrong, or nothing: threads that wait for ever,
/// lanes that meet in different calls, a trap.
std::string run(unsigned blocks, unsigned threads, std::size_t shared, const std::function<void()>& body);
/// True in a kernel. Elsewhere each function below is that of a warp of one lane.
bool in_kernel();

enum class call : std::uint8_t {
  sync,
  sync_and,
  sync_or,
  sync_count,
  warp,
  ballot,
  any,
  all,
  match,
  shuffle,
  xored,
  up,
  down,
  sum,
  least,
  most
};

/// All threads of the block that have not ended; returns how many said `mine`.
unsigned meet_block(call what, bool mine);
/// All lanes of `mask` that have not ended.
std::uint64_t meet_warp(call what, unsigned mask, std::uint64_t mine, int lane = 0);
/// The lanes that are at the same place, or some of them.
unsigned lanes_here(const void* place);

/// Others may run here.
void between();
/// This thread waits for another: others do run.
void wait_for_others();
[[noreturn]] void fail(const std::string& why);

/// A copy that may be done at any time until it is waited for.
void copy_later(void* to, const void* from, std::size_t bytes);
void end_of_copies();
void wait_for_copies(unsigned but_last);

}  // namespace emulated
