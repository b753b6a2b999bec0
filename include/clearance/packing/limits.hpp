// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/packing.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace clearance {

/// Lengths that follow from a solid's size and the options, in metres.
struct pack_limits {
  double scale;       ///< For rounding errors: no coordinate is larger.
  double least_room;  ///< No smaller sphere is searched for, whatever the options say.
  double smallest;    ///< The least radius.

  /// Throws std::invalid_argument for options or bounds that make no sense.
  pack_limits(const Eigen::AlignedBox3d& box, const pack_options& options) {
    if (box.isEmpty() || !(box.diagonal().norm() > 0) || !std::isfinite(box.diagonal().norm()))
      throw std::invalid_argument("clearance::pack: the solid's bounds are empty or not finite");
    for (const double x : {options.smallest_radius, options.gap_target, options.seconds})
      if (!(x >= 0))
        throw std::invalid_argument("clearance::pack: smallest_radius, gap_target and seconds must not be negative");
    if (!(options.gap_per_radius > 0)) throw std::invalid_argument("clearance::pack: gap_per_radius must be positive");
    if (!(options.gap_tolerance > 0)) throw std::invalid_argument("clearance::pack: gap_tolerance must be positive");
    scale = box.diagonal().norm() + box.center().norm();
    least_room = 1e-6 * box.diagonal().norm();
    smallest = std::max(options.smallest_radius, least_room);
  }

  /// Why there is nothing left to divide.
  pack_stop exhausted() const { return smallest > least_room ? pack_stop::smallest_radius : pack_stop::no_room; }
};

/// Called between spheres: reports progress, and returns a reason to stop, if there is one. The certified gap is slow,
/// so it is computed only after every quarter more spheres.
class stop_check {
 public:
  explicit stop_check(const pack_options& options) : options_(options) {}

  template <class Seconds, class Gap>
  std::optional<pack_stop> operator()(std::size_t spheres, Seconds seconds, Gap certified) {
    if (spheres >= options_.count) return pack_stop::count;
    if (options_.progress) options_.progress(spheres, options_.count);
    if (options_.cancelled && options_.cancelled()) return pack_stop::cancelled;
    if (options_.seconds > 0 && seconds() > options_.seconds) return pack_stop::time;
    if (!(options_.gap_target > 0) || spheres < gap_asked_at_) return {};
    gap_asked_at_ = spheres + spheres / 4;
    if (certified() <= options_.gap_target) return pack_stop::gap;
    return {};
  }

 private:
  const pack_options& options_;
  std::size_t gap_asked_at_ = 32;
};

/// Sorts the spheres and computes the totals.
inline void arrange(packing& p, double volume) {
  std::stable_sort(p.spheres.begin(), p.spheres.end(),
                   [](const auto& a, const auto& b) { return a.radius > b.radius; });
  if (!p.spheres.empty()) p.radius_max = p.spheres.front().radius, p.radius_min = p.spheres.back().radius;
  for (const inner_sphere& s : p.spheres) p.fill += 4.0 / 3 * std::numbers::pi * std::pow(double(s.radius), 3) / volume;
}

}  // namespace clearance
