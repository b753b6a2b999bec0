// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What several cameras hide together, part by part.

#include <clearance/minimum/merge.hpp>
#include <clearance/robot/widened.hpp>

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

namespace clearance {

/// A part, and where the room that no camera sees is nearest to it: `cloud` is the camera, `point` the pixel, `at` lies
/// on the pixel's way. Metres.
struct unseen_part : part_witness {
  real lower = 0;        ///< At least so far away is all that no camera sees and some camera hides.
  real out_of_view = 0;  ///< Which share of the ball around the part no camera shows. Nothing is said about that. NaN
                         ///< if a ray image may show the rest.
  real to_edge = not_a_number;  ///< If `edges` are asked for: the ball around the part is at least so far from all
                                ///< that no image shows; 0 if some of it is there, NaN of ray images alone. Metres.
};

/// `all`: as a min_distance_result. If the robot reaches into what is hidden its state is `unknown`. `seen` counts
/// pixels, `valid` those that hide room. With several cameras a place is hidden only if no camera sees it: `lower`
/// holds for that, `distance` is an estimate, and `upper` is not known (infinite).
struct unseen_result {
  min_distance_result all;
  std::vector<unseen_part> parts;
  min_distance_result own_shadow;  ///< What pixels of the robot's own points (`masked`) hide, of all cameras together.
};

namespace minimum {

/// What one camera says about each part. It is kept from frame to frame.
struct camera_finding {
  min_distance_result all;
  std::vector<part_witness> nearest;
  std::vector<double> lower, own;  ///< How far at least all is that it hides, and its own shadow.
  std::vector<double> from_edge;
  std::vector<std::uint64_t> shown;  ///< Of the samples of a part's ball, one bit each.
  bool tells_shown, vague;

  void clear() { nearest.clear(), lower.clear(), own.clear(), from_edge.clear(), shown.clear(); }
};

/// A place is unseen only if no camera sees it. So what camera j hides near a part is also hidden by every other
/// camera, or by the robot before it, or out of its view.
inline void join(std::span<const camera_finding> cameras, real farthest, std::span<const double> radii, bool edges,
                 std::size_t parts, unseen_result& r) {
  if (cameras.empty()) return;
  if (r.own_shadow.state == state::collision) r.own_shadow.state = state::unknown;
  r.all = cameras[0].all;
  for (const camera_finding& other : cameras.subspan(1)) {
    const min_distance_result& more = other.all;
    r.all.seen += more.seen, r.all.valid += more.valid;
    for (int i = 0; i < drop_reasons; ++i) r.all.dropped[i] += more.dropped[i];
  }
  // A pixel without a direction shows and hides nothing. If no other is there, nothing is known.
  const bool blind = r.all.seen == r.all.dropped[int(drop_reason::not_finite)];
  double lower = infinity;
  const unseen_part* least = nullptr;
  r.parts.resize(parts);
  for (std::size_t k = 0; k < parts; ++k) {
    unseen_part& part = r.parts[k];
    double its_lower = infinity;
    std::uint64_t shown = 0;
    bool tells_shown = true;
    double edge = -1;
    for (const camera_finding& j : cameras) {
      double distance = j.nearest[k].distance, at_least = j.lower[k];
      for (const camera_finding& i : cameras)
        if (&i != &j) {
          distance = std::max(distance, std::min<double>(i.nearest[k].distance, std::max(i.from_edge[k], 0.0)));
          at_least = std::max(at_least, std::min({i.lower[k], i.own[k], i.from_edge[k]}));
        }
      if (distance < part.distance) static_cast<part_witness&>(part) = j.nearest[k], part.distance = real(distance);
      its_lower = std::min(its_lower, at_least);
      shown |= j.shown[k], tells_shown &= j.tells_shown;
      if (j.tells_shown) edge = std::max({edge, j.from_edge[k], 0.0});
    }
    if (edges && edge >= 0) part.to_edge = rounded_down(edge);
    part.lower = its_lower > 0 && !blind ? rounded_down(its_lower) : 0;
    const int out_of_view = 64 - std::popcount(shown);
    part.out_of_view = tells_shown || out_of_view == 0 ? real(out_of_view) / 64 : not_a_number;
    lower = std::min(lower, its_lower);
    if (least == nullptr || part.distance < least->distance) least = &part;
  }
  if (blind || least == nullptr) return;
  min_distance_result& all = r.all;
  if (cameras.size() > 1 || all.part == none) {
    all.cloud = least->cloud, all.point = least->point, all.part = least->part, all.primitive = least->primitive;
    all.at = least->at, all.nearest = least->nearest, all.normal = least->normal;
    all.distance = least->distance, all.upper = infinity;
  }
  all.lower = lower > 0 ? rounded_down(lower) : 0;
  const bool vague = std::ranges::any_of(cameras, &camera_finding::vague);
  if (vague) all.upper = infinity;
  const double radius = all.part == none ? 0 : radius_of(radii, all.part);
  const bool reaches = all.distance + radius <= 4 * slack * farthest;  // up to rounding
  all.state = all.lower > 0 ? state::free : reaches && !vague ? state::unknown : state::possible;
}

}  // namespace minimum

}  // namespace clearance
