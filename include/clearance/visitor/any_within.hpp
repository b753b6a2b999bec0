// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks a tree whether anything is near enough.

#include <clearance/concepts.hpp>

namespace clearance {

/// Is anything as close as `margin`? Stops at the first hit.
struct any_within {
  using result_type = bool;

  real margin;
  bool found = false;

  CLEARANCE_HD real reach() const { return found ? -infinity : margin; }
  CLEARANCE_HD void offer(std::uint32_t, real distance) { found = found || distance <= margin; }
  CLEARANCE_HD bool result() const { return found; }
};

static_assert(visitor<any_within>);

}  // namespace clearance
