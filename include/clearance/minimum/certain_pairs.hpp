// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is certain of each part's distance, and how answers about pieces of the clouds become one.

#include <clearance/minimum/of_pieces.hpp>
#include <clearance/scan/interior.hpp>

#include <tuple>

namespace clearance {

/// What lies between the distance of a pair and what is certain of it, one by one. Metres.
struct uncertainty_shares {
  double noise = 0, calibration = 0, time = 0;  ///< Of the point.
  double joints = 0, delay = 0;                 ///< Of the part.
  double gap = 0;                               ///< The part's gap and tolerance.
  double rounding = 0;

  double sum() const { return noise + calibration + time + joints + delay + gap + rounding; }
};

/// The pair of a part that is least far apart for certain. `distance` is what was measured, `lower` the rest, at least
/// 0. The pair need not be the nearest. Without a valid point the distance is infinite.
struct certain_pair : part_witness {
  real lower = 0;
  uncertainty_shares shares;
  real to_ball = infinity;  ///< Metres from the part to the ball around the point, the nearest ball.
};

/// `lower <= distance to the solid <= upper` if no radius is too small. `certain` is the pair that decides `lower`.
/// `collision`: a point is inside by more than all radii, which of a part that is a mesh is not known: `possible`.
/// `nominal` is what min_distance says about the same points.
struct certain_distance_result {
  clearance::state state = clearance::state::no_data;
  real lower = 0, upper = infinity;
  min_distance_result nominal;
  certain_pair certain;
  std::vector<certain_pair> parts;
  std::uint64_t anywhere = 0;  ///< So many points may be anywhere: if it is not 0, nothing is free.
  bool any_radius = false;     ///< Some cloud was `uncertain`, or parts had radii.
};

namespace minimum {

/// Concludes from what is known of each part's pair and of the nearest one: `state` is `collision` and `upper` 0 if by
/// that a point is inside.
inline void conclude(certain_distance_result& r) {
  double lower = infinity;
  r.certain = {};
  for (certain_pair& part : r.parts) {
    if (part.point == none) continue;
    const uncertainty_shares& s = part.shares;
    const double its = double(part.to_ball) - s.gap - s.rounding - (s.joints + s.delay);
    part.lower = its > 0 && r.anywhere == 0 ? rounded_down(its) : 0;
    if (its < lower) lower = its, r.certain = part;
  }
  if (r.nominal.part == none) return;  // nothing is known
  const bool inside = (r.any_radius ? r.state : r.nominal.state) == state::collision;
  if (!r.any_radius) r.upper = r.nominal.upper;
  r.lower = lower > 0 && r.anywhere == 0 && !inside ? rounded_down(lower) : 0;
  r.state = inside ? state::collision : r.lower > 0 ? state::free : state::possible;
}

/// Answers about pieces of all clouds, up to that of one call.
template <class PartView>
class joined_certain {
 public:
  template <class Q>
  joined_certain(const Q&, std::span<const part_facts>) {}

  void add(certain_distance_result piece, const piece_place& place) {
    const auto put = [&](auto& r) {
      if (r.cloud != none) r.point += place.first[r.cloud];
    };
    put(piece.nominal);
    for (certain_pair& part : piece.parts) put(part);
    const of_pieces nominal(piece.nominal);
    if (!any_) {
      all_ = std::move(piece), nominal_ = nominal, any_ = true;
      return;
    }
    if (nearer(nominal.all, nominal_.all)) all_.state = piece.state, all_.upper = piece.upper;
    nominal_.add(nominal);
    all_.anywhere += piece.anywhere;
    for (std::size_t k = 0; k < piece.parts.size(); ++k) {
      const certain_pair &its = piece.parts[k], &best = all_.parts[k];
      if (std::tie(its.to_ball, its.cloud, its.point) < std::tie(best.to_ball, best.cloud, best.point))
        all_.parts[k] = its;
    }
  }
  certain_distance_result result() const {
    certain_distance_result r = all_;
    if (!any_) return r;
    r.nominal = nominal_.answer(scan::has_interior<PartView>);
    conclude(r);
    return r;
  }

 private:
  certain_distance_result all_;
  of_pieces nominal_;
  bool any_ = false;
};

}  // namespace minimum

}  // namespace clearance
