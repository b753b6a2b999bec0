// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A few walks that each take long and go different ways, such as one for each part.

#include <clearance/scan/walk_of.hpp>

namespace clearance::minimum {

/// The places of up to so many parts go with the launch.
inline constexpr std::uint32_t few = 12;

/// Calls the body for one number in 32.
template <class F, class Walk>
struct alone_in_warp {
  static constexpr std::size_t lanes = 32;
  F body;
  Walk walk;
  CLEARANCE_HD void operator()(std::size_t i) const {
    if (i % lanes == 0) body(i / lanes, walk);
  }
};

template <class F, class Walk>
struct with_walk {
  F body;
  Walk walk;
  CLEARANCE_HD void operator()(std::size_t i) const { body(i, walk); }
};

/// How a backend runs bodies apart. A device shares each walk among the lanes of a warp: warp_walk.cuh. With a
/// traversal of `plain` one lane of a warp walks, because lanes that go different ways wait for one another.
template <class On>
struct apart {
  /// body(i, walk) for each of 0 .. n-1; `walk` is a traversal. All threads that call a body with one i write the same,
  /// or find nothing. Throws std::invalid_argument as walk_of.
  template <class PartView, class F>
  static void each(const On& on, const model_view<PartView>& model, std::size_t n, const F& body) {
    const auto walk = scan::walk_of(on, model);
    using walk_type = std::remove_const_t<decltype(walk)>;
    if constexpr (requires { typename On::own_scan; }) {
      static_assert(requires { on.walk; }, "a device does it otherwise: include minimum/warp_walk.cuh");
      on.for_each(n * alone_in_warp<F, walk_type>::lanes, alone_in_warp<F, walk_type>{body, walk});
    } else {
      on.for_each(n, with_walk<F, walk_type>{body, walk});
    }
  }
};

}  // namespace clearance::minimum
