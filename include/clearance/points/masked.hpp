// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A mask that hides points, such as the robot's own.

#include <clearance/ground/read_only.hpp>
#include <clearance/points/passes_on.hpp>

namespace clearance {

/// Whose a point is. One byte, so that a mask of labels is an image.
enum class point_label : std::uint8_t {
  rest,       ///< A point that is not the robot's.
  own,        ///< A point of the robot.
  uncertain,  ///< Perhaps a point of the robot. It is not hidden.
  no_point,   ///< There was no valid point.
};

/// A source without the points labelled `own`, as fast as the source itself. They are dropped as `masked`, and the
/// others keep their numbers. `labels`, one per point, lie where the query's backend can read them; the source may be
/// anywhere.
template <point_source S>
struct masked : passes_on<masked<S>, S, sources::copied, sources::copied_in_pieces> {
  static_assert(points_alone<S>());
  using can = can_all<typename masked::passed, clearance::can<sources::checked>,
                      can_as<S, sources::fetched, sources::surveyed>>;

  S source;
  const point_label* labels;
  static constexpr auto viewed = &masked::source;

  CLEARANCE_HD masked(const S& source, const point_label* labels) : source(source), labels(labels) {}

  CLEARANCE_HD sample operator[](std::size_t i) const {
    sample s = source[i];
    if (s.valid() && labels[i] == point_label::own) s.dropped = drop_reason::masked;
    return s;
  }

  struct cursor {
    typename detail::fetched_types<S>::cursor source;
    const std::uint32_t* labels;
  };
  struct four {
    typename detail::fetched_types<S>::four source;
    std::uint32_t labels;
  };
  CLEARANCE_HD bool fetches() const
    requires fetched_source<S>
  {
    return source.fetches() && reinterpret_cast<std::uintptr_t>(labels) % 4 == 0;
  }
  CLEARANCE_HD cursor seek(std::size_t i) const
    requires fetched_source<S>
  {
    return {source.seek(i), reinterpret_cast<const std::uint32_t*>(labels) + i / 4};
  }
  CLEARANCE_HD cursor skip(const cursor& c, std::size_t n) const
    requires fetched_source<S>
  {
    return {source.skip(c.source, n), c.labels + n / 4};
  }
  CLEARANCE_HD four fetch(const cursor& c) const
    requires fetched_source<S>
  {
    return {source.fetch(c.source), read_only(c.labels)};
  }
  CLEARANCE_HD unsigned look(const four& f, std::size_t i, vec3 (&at)[4]) const
    requires fetched_source<S>
  {
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
    if (labels == nullptr && source.size() != 0)
      detail::refuse_source("a mask for " + std::to_string(source.size()) + " points has no labels: they are null");
  }
};

}  // namespace clearance
