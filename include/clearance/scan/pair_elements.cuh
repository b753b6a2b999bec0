// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a block's pairs hold: points, or the capsules that they stand for.

#include <clearance/scan/element.hpp>
#include <clearance/scan/steps.cuh>

namespace clearance::scan {

template <class Tally>
struct pair_elements : tree_steps<Tally> {
  using frame = frame_parts<Tally>;
  using element = typename element_of_tally<Tally>::type;

  static constexpr bool sight = requires { requires decltype(frame::here().head.answer.around)::sight; };
  /// What many tests against balls take of a capsule.
  using root_element = std::conditional_t<sight, frames::sight_test, frames::capsule_test>;
  /// That of a point of this cloud less the origin; it passes no test if there is no such point.
  static __device__ root_element root_element_at(std::uint32_t i, vec3 x, bool any) {
    if constexpr (sight)
      return root_element(any ? x : vec3{not_a_number, 0, 0}, frame::here().origin);
    else
      return root_element(any ? element_at(i, x) : capsule{{not_a_number, 0, 0}, {0, 0, 0}, 0});
  }
  /// A point of this cloud less the origin, or its capsule.
  static __device__ element element_at(std::uint32_t i, vec3 x) {
    if constexpr (std::is_same_v<element, vec3>)
      return x;
    else
      return frame::here().head.answer.around.less(i, x, frame::here().origin);
  }
  /// Is nothing left to learn about a pair, even if it is inside?
  static __device__ bool settled(const typename Tally::block& s, std::uint32_t part, std::uint32_t point, vec3) {
    return Tally::settled(s, part, point);
  }
  static __device__ bool settled(const typename Tally::block& s, std::uint32_t part, std::uint32_t point,
                                 const capsule& all) {
    return Tally::settled(s, part, point) || (all.radius == 0 && Tally::touched(s, part, point));
  }
  /// May a point inside settle its part? Not a capsule's: what has touched before is passed over, in any order.
  static __device__ bool is_certain(const typename Tally::block& s) {
    return std::is_same_v<element, vec3> && Tally::wants_certain(s);
  }
  static __device__ bool near_part(const typename Tally::block& s, std::uint32_t part, vec3 x) {
    return s.near_part[part].passes(x);
  }
  static __device__ bool near_part(const typename Tally::block& s, std::uint32_t part, const capsule& x) {
    return s.near_part[part].passes(frames::capsule_test(x));
  }
};

}  // namespace clearance::scan
