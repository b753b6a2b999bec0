// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A sample of a cloud, as a cloud.

#include <clearance/concepts.hpp>

namespace clearance {

/// Every `stride`-th point of any source, from its first one on.
template <point_source S>
struct thinned {
  static_assert(points_alone<S>());
  S whole;
  std::size_t stride;

  CLEARANCE_HD std::size_t size() const { return (whole.size() + stride - 1) / stride; }
  CLEARANCE_HD sample operator[](std::size_t i) const { return whole[stride * i]; }
  position_error rounding() const { return rounding_of(whole); }
};

}  // namespace clearance
