// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stopwatch.hpp"

#include <cstdio>
#include <string>
#include <unistd.h>

/// One line on a terminal that is written again and again, and is gone at the end. Silent in a pipe.
class progress {
 public:
  ~progress() { clear(); }

  /// At most ten times a second, so that it costs nothing.
  void show(const std::string& what) {
    if (!terminal_ || (shown_ && (since_ += clock_.lap()) < 0.1)) return;
    std::fprintf(stderr, "\r\033[K%s", what.substr(0, 78).c_str());
    shown_ = true;
    since_ = 0;
  }
  void clear() {
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
  }

 private:
  bool terminal_ = ::isatty(STDERR_FILENO) != 0, shown_ = false;
  double since_ = 0;
  stopwatch clock_;
};
