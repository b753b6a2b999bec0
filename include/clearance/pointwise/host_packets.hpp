// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points on the host whose walks ask the same nodes side by side: neighbours together, others alone.

#include <clearance/frame/frame.hpp>
#include <clearance/pointwise/each_point.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/packet.hpp>
#include <clearance/scan/tile_scan.hpp>
#include <clearance/volume/sphere.hpp>

#include <span>
#include <utility>
#include <vector>

namespace clearance::pointwise {

/// What one thread keeps from packet to packet. Each starts with the primitive nearest to an earlier point as a bound.
template <class PartView>
class host_packets {
 public:
  static constexpr std::size_t together = 16;

  /// `stack`: entries that a walk needs.
  host_packets(const PartView* parts, std::span<const frames::placement> places, real d_max, std::uint64_t stack)
      : parts_(parts), places_(places), d_max_(d_max), pending_(stack) {}

  /// Parts within reach of points in a box, the nearest first, for what is asked next. Returns false if there are none.
  bool look_around(const extent& box) {
    near_.clear();
    if (box.lower.x > box.upper.x) return false;
    for (std::uint32_t k = 0; k < places_.size(); ++k)
      if (const ball& around = places_[k].around; scan::may_reach(around, d_max_, box))
        near_.emplace_back(length(fma(0.5f, box.lower + box.upper, -around.center)) - around.radius, k);
    std::sort(near_.begin(), near_.end());
    return !near_.empty();
  }
  const std::vector<std::pair<real, std::uint32_t>>& near() const { return near_; }

  /// `count` points, at most as many as walk together. `point(j)` may be NaN.
  template <class Point>
  void ask(std::size_t count, const Point& point, found* best) {
    std::size_t lead = 0;
    while (lead < count && !is_point(point(lead))) ++lead;
    if (lead == count) return;
    real widest = 0;  // square
    for (std::size_t j = lead; j < count; ++j) {
      const vec3 way = point(j) - point(lead);
      widest = max(widest, dot(way, way));
    }
    if (const real most = distance_ * 0.25f; count > 1 && widest <= most * most)
      ask<together>(count, point, lead, best);
    else
      for (std::size_t j = lead; j < count; ++j)
        if (is_point(point(j))) ask<1>(1, [&](std::size_t) { return point(j); }, 0, best + j);
  }

  static bool is_point(vec3 p) { return p.x == p.x; }

 private:
  using hierarchy_type = typename PartView::hierarchy_type;
  struct seed {
    std::uint32_t part = none;
    scan::primitive_place<hierarchy_type> where = {};
  };

  template <std::size_t Lanes, class Point>
  void ask(std::size_t count, const Point& point, std::size_t lead, found* best) {
    scan::packet<Lanes> all;
    for (std::size_t j = 0; j < Lanes; ++j) all.put(j, j < count ? point(j) : nowhere, d_max_);
    if (last_.part != none) {
      const auto& primitive = last_.where.in(parts_[last_.part].tree);
      for (std::size_t j = 0; j < Lanes; ++j)
        all.within[j] = min(d_max_, primitive.distance(places_[last_.part].part_from_cloud(all[j])));
    }
    for (const auto& [away, k] : near_) visit(k, all, lead, best);
    last_ = next_;
    if (is_point(all[count - 1])) distance_ = best[count - 1].distance;
  }

  /// Points against one part.
  template <std::size_t Lanes>
  void visit(std::uint32_t k, scan::packet<Lanes>& all, std::size_t lead, found* best) {
    const frames::placement& place = places_[k];
    std::uint32_t near[Lanes];
    if (!all.mark(sphere{place.around.center, place.around.radius}, near)) return;
    scan::walking_packet<hierarchy_type, Lanes> here;
    for (std::size_t j = 0; j < Lanes; ++j)
      here.put(j, place.part_from_cloud(all[j]), near[j] != 0 ? all.within[j] : -infinity);
    if constexpr (scan::has_interior<PartView>)
      for (std::size_t j = 0; j < Lanes; ++j)
        if (here.within[j] > -infinity && parts_[k].interior.inside(here[j])) {
          if (here.within[j] >= 0) best[j].offer({0, k, none}), all.within[j] = 0;
          here.within[j] = -infinity;
        }
    here.walk(parts_[k].tree, lead, pending_.data());
    for (std::size_t j = 0; j < Lanes; ++j)
      if (here.best[j] != none) {
        best[j].offer({here.within[j], k, here.best[j]});
        if (best[j].part == k) next_ = {k, here.where[j]};
        all.within[j] = min(all.within[j], here.within[j]);
      }
  }

  static constexpr vec3 nowhere{not_a_number, not_a_number, not_a_number};

  const PartView* parts_;
  std::span<const frames::placement> places_;
  real d_max_;
  std::vector<near_first::entry_of<hierarchy_type>> pending_;
  std::vector<std::pair<real, std::uint32_t>> near_;  ///< Parts within reach, the nearest first.
  seed last_, next_;          ///< The primitive nearest to a point of the last packet, and of this one.
  real distance_ = infinity;  ///< The last point's.
};

}  // namespace clearance::pointwise
