// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A few bodies that each take long and go different ways, such as a walk for each part.

#include <clearance/concepts/backend.hpp>

namespace clearance::backends {

/// Calls the body for one number in 32.
template <class F>
struct alone_in_warp {
  static constexpr std::size_t lanes = 32;
  F body;
  CLEARANCE_HD void operator()(std::size_t i) const {
    if (i % lanes == 0) body(i / lanes);
  }
};

/// body(i) for each of 0 .. n-1. On a device each has a warp for itself: in one warp they would wait for one another.
template <backend On, class F>
void for_each_apart(const On& on, std::size_t n, const F& body) {
  if constexpr (requires { typename On::own_scan; })
    on.for_each(n * alone_in_warp<F>::lanes, alone_in_warp<F>{body});
  else
    on.for_each(n, body);
}

}  // namespace clearance::backends
