// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Each point's own distance: points share nothing, and each has its own bound.

#include <clearance/frames/bracket.hpp>
#include <clearance/visitor/nearest.hpp>

namespace clearance {

/// Where distances go, in memory that the backend can write: one entry per point of all clouds, in order.
struct distances_out {
  real* distance;                      ///< Metres; infinite beyond `d_max`, NaN where there is no point.
  std::uint32_t* part = nullptr;       ///< The nearest part, or ~0u; or null.
  std::uint32_t* primitive = nullptr;  ///< Its nearest primitive, ~0u if the point is inside the part's solid; or null.
};

namespace pointwise {

/// What is nearest to a point: the least distance; of equal ones the lowest part, and of that the lowest primitive.
struct found {
  real distance = infinity;
  std::uint32_t part = none, primitive = none;

  /// Keeps the nearer one; returns true if that is `other`.
  CLEARANCE_HD bool offer(const found& other) {
    const bool nearer =
        other.distance < distance ||
        (other.distance == distance && (other.part < part || (other.part == part && other.primitive < primitive)));
    if (nearer) *this = other;
    return nearer;
  }
};

CLEARANCE_HD inline void write(const distances_out& out, std::size_t i, const found& f) {
  out.distance[i] = f.distance;
  if (out.part != nullptr) out.part[i] = f.part;
  if (out.primitive != nullptr) out.primitive[i] = f.primitive;
}
CLEARANCE_HD inline found read(const distances_out& out, std::size_t i) {
  return {out.distance[i], out.part != nullptr ? out.part[i] : none,
          out.primitive != nullptr ? out.primitive[i] : none};
}

/// An answer for `scan_body`, after `clear_body`. A point's parts come in order.
struct each_point {
  distances_out out;
  real d_max;

  CLEARANCE_HD real reach(std::uint32_t) const { return d_max; }
  CLEARANCE_HD real reach_of_pair(std::uint32_t index, std::uint32_t) const { return min(d_max, out.distance[index]); }
  CLEARANCE_HD bool settled(std::uint32_t index, std::uint32_t) const { return out.distance[index] <= 0; }
  CLEARANCE_HD bool touched(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool ended(std::uint32_t) const { return false; }
  CLEARANCE_HD bool foresees(std::uint32_t, std::uint32_t, vec3, bool, const nearest&) const { return false; }
  CLEARANCE_HD bool take_inside(std::uint32_t index, std::uint32_t k) const {
    if (d_max >= 0) write(out, index, {0, k, none});
    return false;
  }
  CLEARANCE_HD void take_certain() const {}
  CLEARANCE_HD nearest visitor(std::uint32_t index, std::uint32_t k) const { return {reach_of_pair(index, k)}; }
  CLEARANCE_HD void take(std::uint32_t index, std::uint32_t k, const nearest& found) const {
    if (found.best != none && found.within < out.distance[index]) write(out, index, {found.within, k, found.best});
  }
};

/// Initial state: nothing is near any point yet.
template <point_source Source>
struct clear_body {
  Source source;
  distances_out out;
  std::uint32_t first;

  CLEARANCE_HD void operator()(std::size_t i) const {
    write(out, first + i, {source[i].valid() ? infinity : not_a_number});
  }
};

}  // namespace pointwise

}  // namespace clearance
