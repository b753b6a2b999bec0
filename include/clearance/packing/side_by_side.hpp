// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/packing.hpp>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <type_traits>

namespace clearance {

/// Reports what is wrong with one of several solids or meshes: its index from 0, and what() as if it were alone.
struct solid_error : std::invalid_argument {
  std::size_t index;
  solid_error(std::size_t i, const char* what) : std::invalid_argument(what), index(i) {}
};

/// Calls f(0) .. f(n-1) once each, on `threads` threads of TBB (0: TBB decides); for n = 1 from this thread.
template <class F>
void for_each_packing(std::size_t n, unsigned threads, const F& f) {
  const auto all = [&] {
    // They get their own context: if the caller's tasks were cancelled, loops inside would do nothing, and a packing
    // would never end.
    tbb::task_group_context own(tbb::task_group_context::isolated);
    // A thread that waits in a packing must not begin another, which would hold up the first.
    const auto one = [&](std::size_t i) { tbb::this_task_arena::isolate([&] { f(i); }); };
    tbb::parallel_for(std::size_t(0), n, one, tbb::simple_partitioner{}, own);
  };
  if (threads == 0) return all();
  tbb::task_arena arena(int(threads), 1);
  arena.execute(all);
}

/// One set of options for several packings at once. One thread at a time calls its functions, progress is the total,
/// and cancelling cancels all.
class shared_pack_options {
 public:
  shared_pack_options(const pack_options& options, std::size_t packings)
      : options_(options),
        of_(options.count > std::numeric_limits<std::size_t>::max() / packings ? std::numeric_limits<std::size_t>::max()
                                                                               : options.count * packings),
        done_(packings, 0) {}

  /// Options for packing i. It uses the threads of the place where it runs.
  pack_options one(std::size_t i) {
    pack_options own = options_;
    own.threads = 0;
    if (options_.progress) own.progress = [this, i](std::size_t done, std::size_t) { report(i, done); };
    own.cancelled = [this] { return stopped_ || (options_.cancelled && asked()); };
    return own;
  }
  void finished(std::size_t i) {
    const std::lock_guard alone(mutex_);
    done_[i] = options_.count;
  }
  void stop() { stopped_ = true; }

 private:
  void report(std::size_t i, std::size_t done) {
    const std::lock_guard alone(mutex_);
    done_[i] = done;
    std::size_t sum = 0;
    for (const std::size_t each : done_) sum += std::min(each, of_ - sum);
    options_.progress(sum, of_);
  }
  bool asked() {
    const std::lock_guard alone(mutex_);
    if (!stopped_ && options_.cancelled()) stopped_ = true;
    return stopped_;
  }

  const pack_options& options_;
  const std::size_t of_;
  std::vector<std::size_t> done_;  // by packing; `count` once it has finished, however few it made
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
};

/// Calls `make(i, options)` for i = 0 .. n-1: packings side by side, on `options.threads` threads in all. If some
/// throw, the others are cancelled, and the error of the lowest i is thrown, a std::invalid_argument as solid_error.
template <class Make>
auto side_by_side(std::size_t n, const pack_options& options, const Make& make) {
  std::vector<std::invoke_result_t<const Make&, std::size_t, const pack_options&>> made(n);
  if (n == 0) return made;
  shared_pack_options shared(options, n);
  std::vector<std::exception_ptr> errors(n);
  for_each_packing(n, options.threads, [&](std::size_t i) {
    try {
      made[i] = make(i, shared.one(i));
      shared.finished(i);
    } catch (...) {
      errors[i] = std::current_exception();
      shared.stop();
    }
  });
  for (std::size_t i = 0; i < n; ++i) {
    if (!errors[i]) continue;
    try {
      std::rethrow_exception(errors[i]);
    } catch (const std::invalid_argument& error) {
      throw solid_error(i, error.what());
    }
  }
  return made;
}

}  // namespace clearance
