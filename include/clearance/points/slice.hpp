// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A piece of a cloud, as a cloud.

#include <clearance/points/passes_on.hpp>

#include <algorithm>

namespace clearance {

/// Points `begin` to `begin + count - 1` of any source, as fast as the source itself if `begin` is a multiple of four.
template <point_source S>
struct sliced : passes_on<sliced<S>, S, sources::fetched, sources::unfiltered, sources::surveyed, sources::capsules,
                          sources::surveyed_around> {
  static_assert(points_or_balls<S>());
  using can = can_all<typename sliced::passed, can_as<S, sources::copied, sources::shared>>;
  static constexpr bool vague = vague_source<S>, balls = ball_source<S>;

  S whole;
  std::size_t begin, count;
  static constexpr auto viewed = &sliced::whole;

  CLEARANCE_HD sliced(const S& whole, std::size_t begin, std::size_t count)
      : whole(whole), begin(begin), count(count) {}

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD std::size_t number_in_viewed(std::size_t i) const { return begin + i; }
  CLEARANCE_HD sample operator[](std::size_t i) const { return whole[begin + i]; }

  CLEARANCE_HD radius_shares shares(std::size_t i, vec3 p) const
    requires shared_source<S>
  {
    return whole.shares(begin + i, p);
  }

  CLEARANCE_HD bool fetches() const
    requires fetched_source<S>
  {
    return begin % 4 == 0 && whole.fetches();
  }
  /// The source's memory. If the source has `bytes(begin, end)`, only what these points need, from a multiple of 256
  /// bytes on, because copies are aligned so.
  std::span<const std::byte> bytes() const
    requires copied_source<S>
  {
    const std::span<const std::byte> memory = whole.bytes();
    if constexpr (requires { whole.bytes(begin, begin); }) {
      const std::span<const std::byte> some = whole.bytes(begin, begin + count);
      if (some.empty()) return {};
      const auto before = std::size_t(some.data() - memory.data()) / 256 * 256;
      return memory.subspan(before, std::size_t(some.data() + some.size() - memory.data()) - before);
    }
    return memory;
  }
  sliced at(const std::byte* copy) const
    requires copied_source<S>
  {
    if (count == 0) return *this;
    const auto before =
        reinterpret_cast<std::uintptr_t>(bytes().data()) - reinterpret_cast<std::uintptr_t>(whole.bytes().data());
    return sliced(whole.at(reinterpret_cast<const std::byte*>(reinterpret_cast<std::uintptr_t>(copy) - before)), begin,
                  count);
  }
};

/// Points `begin` to `end - 1`, by the source's own `slice` if it has one.
CLEARANCE_CALLS_ANYTHING
template <point_source S>
CLEARANCE_HD auto slice(const S& source, std::size_t begin, std::size_t end) {
  if constexpr (slicing_source<S>)
    return source.slice(begin, end);
  else
    return sliced<S>(source, begin, end - begin);
}

/// Where slice k of `n` about equal slices begins: at a multiple of four, so that points are read in fours, or at the
/// end of the points. For k = n, the number of points.
inline std::size_t first_of_slice(std::size_t points, std::size_t k, std::size_t n) {
  return std::min(points, (points + 3) / 4 * k / n * 4);
}

}  // namespace clearance
