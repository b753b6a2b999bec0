// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/host.hpp>
#include <clearance/solid/solid.hpp>
#include <clearance/solid/vec3d.hpp>

namespace clearance {

/// A solid as packing reads it: a view that is copied as bytes to where packing runs.
///
/// Law: `distance(p, within, enough)` is the solid's distance if that is below `within`, else `within`; it may stop
/// early with any upper bound of at most `enough`. `inside(p)` is the solid's.
///
/// Optional, for faster climbs: `near(p, reach, take)` calls take(i) with the number of each piece of the surface
/// closer to p than `reach`; `nearer(i, p, best)` is the distance to that piece if below `best`, else `best`.
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
