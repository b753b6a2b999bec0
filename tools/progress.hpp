// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>
#include <unistd.h>

/// One line on a terminal that is written again and again, and is gone at the end. Silent in a pipe.
class progress {
 public:
  ~progress() { show(""); }

  void show(const std::string& what) const {
    if (terminal_) std::fprintf(stderr, "\r\033[K%s", what.substr(0, 78).c_str());
  }

 private:
  bool terminal_ = ::isatty(STDERR_FILENO) != 0;
};
