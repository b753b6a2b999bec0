// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A mask that hides points, such as the robot's own.

#include <clearance/concepts.hpp>
#include <clearance/ground/read_only.hpp>

namespace clearance {

/// Whose a point is. One byte, so that a mask of labels is an image.
enum class point_label : std::uint8_t {
  rest,       ///< Not the robot's.
  own,        ///< The robot's.
  uncertain,  ///< Perhaps the robot's. It is not hidden.
  no_point,   ///< There was no valid point.
};

namespace detail {
template <class S>
struct masked_types {};
template <fetched_source S>
struct masked_types<S> {
  struct cursor {
    typename S::cursor source;
    const std::uint32_t* labels;
  };
  struct four {
    typename S::four source;
    std::uint32_t labels;
  };
};
}  // namespace detail

/// A source without the points labelled `own`, as fast as the source itself. They are dropped as `masked`, and the
/// others keep their numbers. `labels`, one per point, lie where the query's backend can read them; the source may be
/// anywhere.
template <point_source S>
struct masked : detail::masked_types<S> {
  static_assert(points_alone<S>());

  S source;
  const point_label* labels;

  CLEARANCE_HD masked(const S& source, const point_label* labels) : source(source), labels(labels) {}

  CLEARANCE_HD std::size_t size() const { return source.size(); }
  CLEARANCE_HD sample operator[](std::size_t i) const {
    sample s = source[i];
    if (s.valid() && labels[i] == point_label::own) s.dropped = drop_reason::masked;
    return s;
  }

  CLEARANCE_HD bool fetches() const
    requires fetched_source<S>
  {
    return source.fetches() && reinterpret_cast<std::uintptr_t>(labels) % 4 == 0;
  }
  CLEARANCE_HD auto seek(std::size_t i) const
    requires fetched_source<S>
  {
    return typename masked::cursor{source.seek(i), reinterpret_cast<const std::uint32_t*>(labels) + i / 4};
  }
  template <class Cursor>
  CLEARANCE_HD Cursor skip(const Cursor& c, std::size_t n) const {
    return {source.skip(c.source, n), c.labels + n / 4};
  }
  template <class Cursor>
  CLEARANCE_HD auto fetch(const Cursor& c) const {
    return typename masked::four{source.fetch(c.source), read_only(c.labels)};
  }
  template <class Four>
  CLEARANCE_HD unsigned look(const Four& f, std::size_t i, vec3 (&at)[4]) const {
    unsigned reasons = source.look(f.source, i, at);
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j)
      if ((f.labels >> 8 * j & 0xff) == unsigned(point_label::own) && (reasons >> 8 * j & 0xff) == 0)
        reasons |= unsigned(drop_reason::masked) << 8 * j;
    return reasons;
  }

  /// See `surveyed_source`. Only if nothing is hidden there.
  bool survey(std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) const
    requires surveyed_source<S>
  {
    bool hidden = false;
    for (std::size_t j = 0; j < surveyed_points; ++j) hidden |= labels[begin + j] == point_label::own;
    return !hidden && source.survey(begin, box, dropped);
  }
  /// See `rounding_of`.
  void check() const {
    if (labels == nullptr && size() != 0)
      detail::refuse_source("a mask for " + std::to_string(size()) + " points has no labels: they are null");
  }
  position_error rounding() const { return rounding_of(source); }

  std::span<const std::byte> bytes() const
    requires requires(const S s) { s.bytes(); }
  {
    return source.bytes();
  }
  masked at(const std::byte* copy) const
    requires requires(const S s, const std::byte* b) { s.at(b); }
  {
    return masked(source.at(copy), labels);
  }
  template <class F>
  masked with_pieces(const F& f) const
    requires requires(const S s, const F f) { s.with_pieces(f); }
  {
    return masked(source.with_pieces(f), labels);
  }
};

}  // namespace clearance
