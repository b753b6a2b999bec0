// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The CPU as a backend: the process's memory, and threads of TBB.

#include <clearance/concepts.hpp>
#include <clearance/ground/indices.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <map>

namespace clearance {

/// Runs on the CPU, on `threads` threads of TBB (0: TBB decides). Memory is the process's own.
struct host {
  template <class T>
  using buffer = std::vector<T>;
  template <class T>
  using scratch = std::vector<T>;

  unsigned threads = 0;

  std::size_t concurrency() const {
    return threads != 0 ? threads : std::size_t(tbb::this_task_arena::max_concurrency());
  }

  /// Calls `body(indices)` for ranges that together cover 0 .. n-1 once and are small enough to balance uneven work:
  /// at most `grain` long, if there is more than one thread.
  template <class F>
  void for_ranges(std::size_t n, F body, std::size_t grain = 1024) const {
    if (n <= grain || threads == 1) return body(indices{0, n, 1});
    const auto all = [&] {
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, n, grain), [&](const auto& r) { body(indices{r.begin(), r.end(), 1}); },
          tbb::simple_partitioner{});
    };
    if (threads == 0) return all();
    arena_of(int(threads)).execute(all);
  }

  template <class F>
  void for_each(std::size_t n, F body) const {
    for_ranges(n, [&](indices range) {
      for (std::size_t i = range.begin; i < range.end; i += range.step) body(i);
    });
  }

  void wait() const {}

  template <class T>
  buffer<T> copy_in(std::span<const T> data) const {
    return {data.begin(), data.end()};
  }
  template <class T>
  std::vector<T> copy_out(const buffer<T>& data) const {
    return data;
  }

  template <class T>
  std::vector<T> copy_out(const T* data, std::size_t n) const {
    return {data, data + n};
  }

  /// Memory for one call.
  template <class T>
  scratch<T> make_scratch(std::size_t n) const {
    return scratch<T>(n);
  }
  template <class T>
  void stage(std::span<const T> data, T* to) const {
    std::copy(data.begin(), data.end(), to);
  }
  bool reads(const void*) const { return true; }

 private:
  friend class host_workers;

  /// This thread's arena of so many threads. It is kept, because TBB 2021.8 never frees one that a worker entered: 7 kB
  /// a call (uxlfoundation/oneTBB#967).
  static tbb::task_arena& arena_of(int threads) {
    thread_local std::map<int, tbb::task_arena> kept;
    return kept.try_emplace(threads, threads, 1).first->second;
  }
};

static_assert(backend<host>);

/// The threads of a `host`. Each takes the next piece of work as soon as it has finished one.
class host_workers {
 public:
  explicit host_workers(const host& on) : threads_(on.threads) {}

  /// Calls `body(begin, end)` for pieces of `grain` that together cover 0 .. n-1 once.
  template <class F>
  void for_pieces(std::size_t n, std::size_t grain, const F& body) {
    const std::size_t pieces = (n + grain - 1) / grain;
    const auto threads = std::min<std::size_t>(host{threads_}.concurrency(), pieces);
    std::atomic<std::size_t> next = 0;
    const auto work = [&](std::size_t) {
      for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < pieces;)
        body(i * grain, std::min(n, (i + 1) * grain));
    };
    const auto all = [&] { tbb::parallel_for(std::size_t(0), threads, work, tbb::simple_partitioner{}); };
    if (threads < 2)
      work(0);
    else if (threads_ == 0)
      all();
    else
      host::arena_of(int(threads_)).execute(all);
  }

 private:
  unsigned threads_;
};

}  // namespace clearance
