// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/room_view.hpp>

namespace clearance {

/// The room around a place, from the few spheres and surface pieces nearby. It is exact below `reach` minus the way
/// from the place, and never too large. If there are too many, all are asked; a solid without pieces is asked as a
/// whole.
template <solid_view V, class Lanes>
class local_list {
 public:
  static constexpr std::uint32_t capacity = 256;

  CLEARANCE_HD local_list(const room_view<V>& all, std::uint32_t* items, Lanes lanes)
      : all_(all), items_(items), lanes_(lanes) {}

  CLEARANCE_HD void prepare(const solid_sphere& now) {
    if (reach_ >= 1.5 * now.radius && (now.center - place_).norm() <= 0.25 * reach_) return;
    place_ = now.center, reach_ = 2 * now.radius, count_ = 0;
    const auto sphere = [this](std::uint32_t i, double best) {
      if (all_.spheres[i].nearer(place_, best) < best) take(i);
      return best;
    };
    lanes_.meet();  // all have read the old list
    if constexpr (knows_pieces) all_.solid.near(place_, reach_, [this](std::uint32_t i) { take(i); });
    pieces_ = count_;
    all_.tree.nearest(place_, reach_, sphere);
    for (std::uint32_t i = all_.tree.items; i < all_.count; ++i) sphere(i, reach_);
    lanes_.meet();
  }
  CLEARANCE_HD double room(const vec3d& p, double within, double enough) const {
    if (count_ > capacity) return all_.room(p, within, enough);
    const double known = reach_ - (p - place_).norm();
    if (known < within) within = known;
    for (std::uint32_t k = pieces_; k < count_ && within > enough; ++k)
      within = all_.spheres[items_[k]].nearer(p, within);
    if constexpr (knows_pieces) {
      for (std::uint32_t k = 0; k < pieces_ && within > enough; ++k) within = all_.solid.nearer(items_[k], p, within);
    } else {
      if (within > enough) within = all_.solid.distance(p, within, enough);
    }
    return within;
  }

 private:
  static constexpr bool knows_pieces = requires(const V v, vec3d p) { v.nearer(std::uint32_t(0), p, 0.0); };

  CLEARANCE_HD void take(std::uint32_t item) {
    if (count_ < capacity && lanes_.rank() == 0) items_[count_] = item;
    ++count_;
  }

  const room_view<V>& all_;
  std::uint32_t* items_;
  Lanes lanes_;
  vec3d place_;
  double reach_ = 0;
  std::uint32_t pieces_ = 0, count_ = 0;  // pieces of the surface, which come first; everything
};

/// Moves an inside sphere that no other touches to a local maximum of the room, at most `farthest` away. Each step
/// stays in the ball that is known to be inside, so none leaves the solid through a thin wall.
template <solid_view V, class Lanes>
CLEARANCE_HD solid_sphere climb(const room_view<V>& in, std::uint32_t* memory, const solid_sphere& from,
                                double farthest, Lanes lanes) {
  local_list<V, Lanes> around(in, memory, lanes);
  return compass_search(
      from, 1e-3, lanes, [&](const solid_sphere& now) { around.prepare(now); },
      [&](const vec3d& p, double most, double least) {
        return (p - from.center).norm() > farthest ? 0 : around.room(p, most * (1 + 1e-12), least);
      });
}

/// Moves and grows an inside sphere, ignoring other spheres, as long as it covers its old middle.
template <solid_view V, class Lanes>
CLEARANCE_HD solid_sphere grow(const V& in, const solid_sphere& from, Lanes lanes) {
  return compass_search(
      from, 1e-2, lanes, [](const solid_sphere&) {},
      [&](const vec3d& p, double most, double least) {
        const double r = in.distance(p, most * (1 + 1e-12), least);
        return (p - from.center).norm() <= r - from.radius / 2 ? r : 0;
      });
}

}  // namespace clearance
