// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A sample of a cloud, as a cloud.

#include <clearance/concepts.hpp>

namespace clearance {

/// Every `stride`-th point of any source, from its first one on. The others are there, but do not count: so a device
/// spreads the sample over as many blocks as it does the whole.
template <point_source S>
struct thinned {
  static_assert(points_alone<S>());
  S whole;
  std::uint32_t stride;

  CLEARANCE_HD std::size_t size() const { return whole.size(); }
  CLEARANCE_HD sample operator[](std::size_t i) const {
    return std::uint32_t(i) % stride == 0 ? whole[i] : sample{{0, 0, 0}, drop_reason::masked};
  }
  position_error rounding() const { return rounding_of(whole); }
};

}  // namespace clearance
