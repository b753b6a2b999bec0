// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks a tree which primitive is nearest.

#include <clearance/concepts.hpp>

namespace clearance {

/// The closest primitive, if any is as close as `within`; of equally close ones the lowest id.
struct nearest {
  static constexpr std::uint32_t none = ~0u;

  struct result_type {
    real distance;
    std::uint32_t primitive;
  };

  real within = infinity;
  std::uint32_t best = none;

  CLEARANCE_HD real reach() const { return within; }
  CLEARANCE_HD void offer(std::uint32_t id, real distance) {
    if (distance < within || (distance == within && id < best)) {
      within = distance;
      best = id;
    }
  }
  CLEARANCE_HD result_type result() const { return {within, best}; }
};

static_assert(visitor<nearest>);

}  // namespace clearance
