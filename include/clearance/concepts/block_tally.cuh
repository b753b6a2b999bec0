// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a block of a device keeps of an answer while a kernel runs. All members are static __device__ functions, because
// the block's memory (`T::block`, in shared memory) holds the state.

#include <clearance/concepts/traversal.hpp>

namespace clearance {

namespace scan {
template <class T>
struct scan_arguments;
}  // namespace scan

/// What every kernel of a scan asks. `arguments` come with the launch, `memory` lies in shared memory and is cleared by
/// `clear(thread)`; `scan_type` is the scan that launches it; `top_bytes` of shared memory hold the first nodes of
/// trees. An `element` is what it makes of a point: its position, or a capsule.
///
/// Law: `reach_of_part(block, part, bound)` never grows while the kernel runs; an old value only costs time.
/// Law: parts may have different reaches only if `bounds_differ(block)`; else one test of a group of parts is for all.
/// Law: all blocks call `hand_in`; then the last one calls `conclude` with all its threads, and `reset` with one, which
/// prepares the next scan.
template <class T>
concept block_tally = requires(typename T::block& s, const scan::scan_arguments<T>& a, std::uint32_t n) {
  typename T::part_type;
  typename T::element;
  typename T::arguments;
  typename T::memory;
  typename T::scan_type;
  { T::bound_per_part } -> std::convertible_to<bool>;
  { T::goes_ahead } -> std::convertible_to<bool>;
  { T::top_bytes } -> std::convertible_to<std::size_t>;
  { T::reach_of_part(s, n, n) } -> std::same_as<real>;
  { T::bounds_differ(s) } -> std::same_as<bool>;
  T::reset(a);
};

/// For the kernel of pairs (scan/kernel.cuh). A pair is a point near a part, with a place in the block's table.
///
/// Law: `take(block, record, primitive, pair)` is called by all lanes of a warp, each with a record or none;
/// `take_inside` instead of a walk, if a point is inside a part's solid; `drained(block, count)` by all threads, when
/// the block has walked all its pairs; `meet(block, reasons, index)` by each thread for its next four points, before
/// their pairs come: why they do not count, and the first one's number. Law: what `skips` and `settled` say of a pair
/// stays true. `news` brings the bounds of other blocks, `seeds` first bounds.
template <class T>
concept pair_tally =
    block_tally<T> && requires(typename T::block& s, const typename T::block& c, std::uint32_t n, vec3 x,
                               const typename T::record& found, const typename T::primitive_type& primitive) {
      typename T::news;
      typename T::seeds;
      { T::reach_of_pair(c, n, n) } -> std::same_as<real>;
      { T::common_bound(c) } -> std::same_as<std::uint32_t>;
      { T::settled(c, n, n) } -> std::same_as<bool>;
      { T::touched(c, n, n) } -> std::same_as<bool>;
      { T::skips(c, n, n, n, x) } -> std::same_as<bool>;
      { T::wants_certain(c) } -> std::same_as<bool>;
      T::meet(c, n, n);
      T::take_inside(s, n, n, n);
      T::take_certain(s);
      T::take(s, found, primitive, n);
      T::drained(s, n);
    };

/// A pair tally that first goes down to one leaf with every pair, and then walks only with the pairs that it left open.
/// With at most `few` pairs it walks at once. `fields(block)`, one per part or null, are looked into before, and may
/// leave `few_left` to walk; `hear_bound(block, part, pair, distance)` takes what they tell from above.
template <class T>
concept leaf_first_tally =
    pair_tally<T> && requires(typename T::block& s, const typename T::block& c, std::uint32_t n, real d) {
      { T::few } -> std::convertible_to<std::uint32_t>;
      { T::few_left } -> std::convertible_to<std::uint32_t>;
      T::fields(c);
      T::hear_bound(s, n, n, d);
      { T::open_pairs(c) } -> std::same_as<std::uint32_t>;
      { T::open_pair(c, n) } -> std::same_as<std::uint32_t>;
      T::leave_open(s, n);
      T::close_all(s);
    };

/// For the kernel of packets (scan/packet_kernel.cuh): each lane has a point with a visitor of its own. `how` is one of
/// scan::packets_by.
///
/// Law: `visitor(block, index, counts)` begins a lane's point, `remind` may lower its reach by what the last frame
/// knows, and `take` ends it. A visitor `hear`s another's and `join`s it, if lanes share a walk.
template <class T>
concept packet_tally =
    block_tally<T> && requires(const typename T::block& s, const typename T::arguments& a, typename T::visitor_type& v,
                               const typename T::visitor_type& other, std::uint32_t n, vec3 x, bool counts) {
      { T::all_near(a) } -> std::same_as<bool>;
      T::how;
      { T::visitor(s, n, counts) } -> std::same_as<typename T::visitor_type>;
      T::remind(s, n, x, v);
      T::take(s, n, counts, other);
      { other.reach(n) } -> std::same_as<real>;
      v.offer_inside(n);
      { v.hear(other) } -> std::same_as<bool>;
      v.join(other);
    };

/// The tally that a kernel takes, with reasons.
template <class T>
consteval bool explain_block_tally() {
  static_assert(block_tally<T>, "a block's tally lacks what every kernel asks: see concepts/block_tally.cuh");
  if constexpr (requires { typename T::visitor_type; })
    static_assert(packet_tally<T>, "a tally for packets lacks a member: see packet_tally in concepts/block_tally.cuh");
  else
    static_assert(pair_tally<T> && (!T::goes_ahead || leaf_first_tally<T>),
                  "a tally for pairs lacks a member: see pair_tally in concepts/block_tally.cuh");
  return true;
}

}  // namespace clearance
