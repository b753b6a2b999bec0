// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A solid made of a function instead of a mesh.

#include <clearance/solid/solid.hpp>

#include <cmath>
#include <stdexcept>

namespace clearance {

/// The solid where a function is negative. Between two points the function must change by at most their distance (as a
/// signed distance does, exact or not); outside the bounds it must be positive. Metres.
template <class F>
class implicit_solid {
 public:
  implicit_solid(F signed_distance, const Eigen::AlignedBox3d& bounds)
      : f_(std::move(signed_distance)), bounds_(bounds) {
    if (bounds.isEmpty() || !bounds.min().allFinite() || !bounds.max().allFinite())
      throw std::invalid_argument("clearance::implicit_solid: the bounds are empty or not finite");
  }
  Eigen::AlignedBox3d bounds() const { return bounds_; }
  double distance(const Eigen::Vector3d& p) const { return std::abs(double(f_(p))); }
  bool inside(const Eigen::Vector3d& p) const { return f_(p) < 0; }

 private:
  F f_;
  Eigen::AlignedBox3d bounds_;
};

static_assert(solid<implicit_solid<double (*)(const Eigen::Vector3d&)>>);

}  // namespace clearance
