// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A piece of a cloud, as a cloud.

#include <clearance/concepts.hpp>

#include <algorithm>

namespace clearance {

namespace detail {
template <class S>
struct fetched_types {};
template <fetched_source S>
struct fetched_types<S> {
  using cursor = typename S::cursor;
  using four = typename S::four;
};
}  // namespace detail

/// Points `begin` to `begin + count - 1` of any source, as fast as the source itself if `begin` is a multiple of four.
template <point_source S>
struct sliced : detail::fetched_types<S> {
  static_assert(points_alone<S>());
  S whole;
  std::size_t begin, count;

  CLEARANCE_HD sliced(const S& whole, std::size_t begin, std::size_t count)
      : whole(whole), begin(begin), count(count) {}

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD sample operator[](std::size_t i) const { return whole[begin + i]; }

  CLEARANCE_HD bool fetches() const
    requires fetched_source<S>
  {
    return begin % 4 == 0 && whole.fetches();
  }
  CLEARANCE_HD auto seek(std::size_t i) const
    requires fetched_source<S>
  {
    return whole.seek(begin + i);
  }
  template <class Cursor>
  CLEARANCE_HD auto skip(const Cursor& c, std::size_t n) const {
    return whole.skip(c, n);
  }
  template <class Cursor>
  CLEARANCE_HD auto fetch(const Cursor& c) const {
    return whole.fetch(c);
  }
  template <class Four>
  CLEARANCE_HD unsigned look(const Four& f, std::size_t i, vec3 (&at)[4]) const {
    return whole.look(f, begin + i, at);
  }

  CLEARANCE_HD bool unfiltered() const
    requires unfiltered_source<S>
  {
    return whole.unfiltered();
  }
  bool survey(std::size_t i, extent& box, std::uint32_t (&dropped)[drop_reasons]) const
    requires surveyed_source<S>
  {
    return whole.survey(begin + i, box, dropped);
  }
  position_error rounding() const { return rounding_of(whole); }

  /// The source's memory. If the source has `bytes(begin, end)`, only what these points need, from a multiple of 256
  /// bytes on, because copies are aligned so.
  std::span<const std::byte> bytes() const
    requires requires(const S s) { s.bytes(); }
  {
    const std::span<const std::byte> all = whole.bytes();
    if constexpr (requires { whole.bytes(begin, begin); }) {
      const std::span<const std::byte> some = whole.bytes(begin, begin + count);
      if (some.empty()) return {};
      const auto before = std::size_t(some.data() - all.data()) / 256 * 256;
      return all.subspan(before, std::size_t(some.data() + some.size() - all.data()) - before);
    }
    return all;
  }
  sliced at(const std::byte* copy) const
    requires requires(const S s, const std::byte* b) { s.at(b); }
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
  if constexpr (requires {
                  { source.slice(begin, end) } -> point_source;
                })
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
