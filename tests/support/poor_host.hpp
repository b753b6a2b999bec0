// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <clearance/backends/host.hpp>

#include <new>

namespace testing {

/// A backend without memory for much.
struct poor : clearance::host {
  template <class T>
  scratch<T> make_scratch(std::size_t n) const {
    if (n > 1000) throw std::bad_alloc();
    return host::make_scratch<T>(n);
  }
};

}  // namespace testing
