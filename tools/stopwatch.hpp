// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

/// Seconds since it was made, or since the last call.
class stopwatch {
 public:
  double lap() {
    const auto now = clock::now();
    const double seconds = std::chrono::duration<double>(now - from_).count();
    from_ = now;
    return seconds;
  }

 private:
  using clock = std::chrono::steady_clock;
  clock::time_point from_ = clock::now();
};
