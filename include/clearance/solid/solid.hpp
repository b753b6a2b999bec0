// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What packing needs to know of a solid, and how the solid gets to where packing runs.

#include <clearance/backends/host.hpp>
#include <clearance/solid/vec3d.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clearance {

/// What can be packed: anything that knows its bounds, its distance and its inside. Metres, in double. Several threads
/// call const members at once.
///
/// Law: `bounds()` contains the solid.
/// Law: `distance(p)` is not negative, and at most the distance from p to the surface, inside and outside alike.
/// Between two points it differs by at most their distance.
/// Law: `inside(p)` is the same for all points that no surface separates, unless the view is `porous()`.
///
/// Optional: `tolerance()`, metres from the surface within which `inside` may be wrong; `volume()` in cubic metres, for
/// the fill ratio; `surface_points(count)`, evenly spread over the surface, for mean gaps; `corners()`, where gaps tend
/// to be largest; `distance(p, within)`, faster if distances above `within` do not matter; `view()`, a `solid_view` to
/// use instead; `on(backend)`, to pack elsewhere than on a host.
template <class S>
concept solid = requires(const S s, Eigen::Vector3d p) {
  { s.bounds() } -> std::convertible_to<Eigen::AlignedBox3d>;
  { s.distance(p) } -> std::same_as<double>;
  { s.inside(p) } -> std::same_as<bool>;
};

/// A solid as packing reads it: a view that is copied as bytes to where packing runs.
///
/// Law: `distance(p, within, enough)` is the solid's distance if that is below `within`, else `within`; it may stop
/// early with any upper bound of at most `enough`. `inside(p)` is the solid's.
///
/// Optional, for faster climbs: `near(p, reach, take)` calls take(i) with the number of each piece of the surface
/// closer to p than `reach`; `nearer(i, p, best)` is the distance to that piece if below `best`, else `best`.
/// `porous()`, if the inside may end where no surface is: then packing asks `inside` of every place.
template <class V>
concept solid_view = std::is_trivially_copyable_v<V> && requires(const V v, vec3d p, double d) {
  { v.distance(p, d, d) } -> std::same_as<double>;
  { v.inside(p) } -> std::same_as<bool>;
};

/// A reference to any solid, for a host.
template <solid S>
struct solid_reference {
  const S* of;

  /// NaN stays NaN, and no room is found there.
  CLEARANCE_CALLS_ANYTHING
  CLEARANCE_HD double distance(const vec3d& p, double within, double = 0) const {
    if constexpr (requires {
                    { of->distance(Eigen::Vector3d(), within) } -> std::same_as<double>;
                  }) {
      return of->distance(p, within);
    } else {
      const double d = of->distance(p);
      return within < d ? within : d;
    }
  }
  CLEARANCE_CALLS_ANYTHING
  CLEARANCE_HD bool inside(const vec3d& p) const { return of->inside(p); }
};

/// Can S be packed on B? On a host every solid can; elsewhere `on(backend)` must return a copy with a `view()`.
template <class S, class B>
concept solid_for = solid<S> && (std::same_as<B, host> || requires(const S s, const B on) {
                      { s.on(on).view() } -> solid_view;
                    });

/// Keeps alive what its `view()` reads.
template <backend B, solid_for<B> S>
class solid_there {
 public:
  solid_there(const B& on, const S& s) : copy_(s.on(on)) {}
  auto view() const { return copy_.view(); }

 private:
  decltype(std::declval<const S&>().on(std::declval<const B&>())) copy_;
};
template <solid S>
class solid_there<host, S> {
 public:
  solid_there(const host&, const S& s) : of_(&s) {}
  auto view() const {
    if constexpr (requires {
                    { of_->view() } -> solid_view;
                  })
      return of_->view();
    else
      return solid_reference<S>{of_};
  }

 private:
  const S* of_;
};

}  // namespace clearance
