// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stopwatch.hpp"

#include <clearance/io/sentence.hpp>

#include <unistd.h>
#include <cstdio>
#include <string>

/// One line on a terminal, rewritten again and again, and erased at the end. Silent in a pipe.
class progress {
 public:
  ~progress() { clear(); }

  /// At most ten times a second, so that it costs little.
  void show(const std::string& what) {
    doing_ = what;
    if (!terminal_ || (shown_ && (since_ += clock_.lap()) < 0.1)) return;
    std::fprintf(stderr, "\r\033[K%s", clearance::io::sentence(what, 78).c_str());
    shown_ = true;
    since_ = 0;
  }
  /// The text shown last: what is being done.
  static const std::string& doing() { return doing_; }

  void clear() {
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
  }

 private:
  inline static std::string doing_;
  bool terminal_ = ::isatty(STDERR_FILENO) != 0, shown_ = false;
  double since_ = 0;
  stopwatch clock_;
};
