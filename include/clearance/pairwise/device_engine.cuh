// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/kept_memory.cuh>
#include <clearance/frame/readable.cuh>
#include <clearance/pairwise/device_pairs.cuh>
#include <clearance/pairwise/pairs_on.hpp>

namespace clearance::pairwise {

/// On a device: the kernel of a scan.
template <>
struct pairs_on<device> {
  static constexpr bool meets_points = true;
  template <class PartView>
  using kept = device_pairs<PartView>;
};

}  // namespace clearance::pairwise
