// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where points come from, and what makes reading them fast.

#include <clearance/ground/math.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace clearance {

/// Why a record or pixel gave no point. `too_close`: something is there, nearer than the sensor can measure (REP 117);
/// nothing is `free` then.
enum class drop_reason : std::uint8_t { none, not_finite, missing, saturated, out_of_range, masked, too_close };
inline constexpr int drop_reasons = 7;

/// The answer of a point source for one index: a position in its own frame, or why there is none.
struct sample {
  vec3 position;
  drop_reason dropped = drop_reason::none;

  CLEARANCE_HD constexpr bool valid() const { return dropped == drop_reason::none; }
};

/// Where points come from: a view that is read in place, without a copy.
///
/// Law: `s[i]` is pure; a valid sample has a finite position; positions are metres in the source's own frame.
template <class S>
concept point_source = std::is_trivially_copyable_v<S> && requires(const S s, std::size_t i) {
  { s.size() } -> std::convertible_to<std::size_t>;
  { s[i] } -> std::same_as<sample>;
};

/// A source that a kernel reads ahead: it fetches the next four neighbours while it looks at these.
///
/// Law: where `fetches()`, for i % 4 == 0 and i + 3 < size(), `look(fetch(seek(i)), i, at)` sets `at` to the positions
/// of s[i] to s[i + 3] (if valid) and returns their drop reasons, the first in the lowest byte.
/// Law: `skip(seek(i), n)` is `seek(i + n)`, for n % 4 == 0; it may lie behind the end, and is then not fetched.
template <class S>
concept fetched_source = point_source<S> && requires(const S s, std::size_t i, const typename S::cursor& c,
                                                     const typename S::four& f, vec3 (&at)[4]) {
  { s.fetches() } -> std::same_as<bool>;
  { s.seek(i) } -> std::same_as<typename S::cursor>;
  { s.skip(c, i) } -> std::same_as<typename S::cursor>;
  { s.fetch(c) } -> std::same_as<typename S::four>;
  { s.look(f, i, at) } -> std::same_as<unsigned>;
};

/// A source whose points are an image's, row by row: neighbours above one another are neighbours too.
///
/// Law: `columns()` is the number of points in a row.
template <class S>
concept image_source = point_source<S> && requires(const S s) {
  { s.columns() } -> std::same_as<std::uint32_t>;
};

/// A source that says when it filters nothing: then every point with finite coordinates counts, and every position can
/// be read.
template <class S>
concept unfiltered_source = point_source<S> && requires(const S s) {
  { s.unfiltered() } -> std::same_as<bool>;
};

/// A box around points; empty (lower > upper) if there are none.
struct extent {
  vec3 lower = {infinity, infinity, infinity}, upper = {-infinity, -infinity, -infinity};

  CLEARANCE_HD void add(vec3 p) {
    lower = {min(lower.x, p.x), min(lower.y, p.y), min(lower.z, p.z)};
    upper = {max(upper.x, p.x), max(upper.y, p.y), max(upper.z, p.z)};
  }
};

/// A source that says where 128 neighbours are, without taking them apart. A host asks this first.
///
/// Law: if `survey(begin, box, dropped)` is true, `box` holds all valid positions of s[begin] to s[begin + 127], and
/// `dropped` was increased by the number of invalid ones, by reason; if it is false, nothing was added.
inline constexpr std::size_t surveyed_points = 128;
template <class S>
concept surveyed_source =
    point_source<S> && requires(const S s, std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) {
      { s.survey(begin, box, dropped) } -> std::same_as<bool>;
    };

/// How far from its point a position may be: at most `absolute + relative * (its distance from the source's (0,0,0))`,
/// in metres. It covers what was lost before the source was made, and what is lost when it is read. The bracket of
/// every distance carries it.
struct position_error {
  double absolute = 0, relative = 0;
};

namespace detail {

[[noreturn, gnu::noinline, gnu::cold]] inline void refuse_source(const std::string& why) {
  throw std::invalid_argument("clearance: " + why);
}
/// Throws std::invalid_argument unless `nearest` to `farthest` is a range.
inline void check_range(double nearest, double farthest, const char* what) {
  if (!(nearest <= farthest))
    refuse_source(std::string(what) + " counts from " + std::to_string(nearest) + " m to " + std::to_string(farthest) +
                  " m, which is no range");
}

}  // namespace detail

/// From the optional member `position_error rounding() const`, called on the host; a source without it is exact. Every
/// question asks this of every cloud before it reads a point. So it also calls the optional member `void check()
/// const`, which throws std::invalid_argument if the source's numbers contradict one another; and throws that itself
/// for an error that is negative or not finite.
template <point_source S>
position_error rounding_of(const S& source) {
  if constexpr (requires { source.check(); }) source.check();
  if constexpr (requires {
                  { source.rounding() } -> std::same_as<position_error>;
                }) {
    const position_error its = source.rounding();
    for (const double x : {its.absolute, its.relative})
      if (!(x >= 0 && x < double(infinity)))
        detail::refuse_source("a cloud's points are off by up to " + std::to_string(its.absolute) + " m and by " +
                              std::to_string(its.relative) + " of their distance, which must be finite and 0 or more");
    return its;
  } else {
    return {};
  }
}

/// How far p, where point i of a source is `out_of_range`, is from its range, in metres: not more than it is. From the
/// optional member `real beyond(std::size_t i, vec3 p) const`, a filter, or the source that it views. Infinite if none
/// says: such a point is out, however uncertain it is.
template <point_source S>
CLEARANCE_HD real beyond_range(const S& s, std::size_t i, vec3 p) {
  if constexpr (requires {
                  { s.beyond(i, p) } -> std::same_as<real>;
                })
    return s.beyond(i, p);
  else if constexpr (requires {
                       { s.filter.beyond(p) } -> std::same_as<real>;
                     })
    return s.filter.beyond(p);
  else if constexpr (requires { requires point_source<std::remove_cvref_t<decltype(s.source)>>; })
    return beyond_range(s.source, i, p);
  else if constexpr (requires { s.whole, s.begin; })
    return beyond_range(s.whole, s.begin + i, p);
  else if constexpr (requires { requires point_source<std::remove_cvref_t<decltype(s.whole)>>; })
    return beyond_range(s.whole, i, p);
  else
    return infinity;
}

/// Where a source's points are seen from, in its frame: (0,0,0), or where its filter has the sensor. From the optional
/// member `vec3 sensor() const`, a filter, or the source that it views.
template <point_source S>
CLEARANCE_HD vec3 sensor_of(const S& s) {
  if constexpr (requires {
                  { s.sensor() } -> std::same_as<vec3>;
                })
    return s.sensor();
  else if constexpr (requires { s.filter.sensor; })
    return s.filter.sensor;
  else if constexpr (requires { requires point_source<std::remove_cvref_t<decltype(s.source)>>; })
    return sensor_of(s.source);
  else if constexpr (requires { requires point_source<std::remove_cvref_t<decltype(s.whole)>>; })
    return sensor_of(s.whole);
  else if constexpr (requires { requires point_source<std::remove_cvref_t<decltype(s.piece(0))>>; })
    return sensor_of(s.piece(0));
  else
    return {0, 0, 0};
}

/// `point_source<S>` with reasons.
template <class S>
consteval bool explain_point_source() {
  static_assert(std::is_trivially_copyable_v<S>, "a point source must be a trivially copyable view");
  static_assert(
      requires(const S s) {
        { s.size() } -> std::convertible_to<std::size_t>;
      }, "a point source needs: CLEARANCE_HD std::size_t size() const");
  static_assert(
      requires(const S s, std::size_t i) {
        { s[i] } -> std::same_as<sample>;
      }, "a point source needs: CLEARANCE_HD sample operator[](std::size_t) const");
  if constexpr (requires(const S s) { s.rounding(); })
    static_assert(
        requires(const S s) {
          { s.rounding() } -> std::same_as<position_error>;
        }, "what a point source has by the name rounding must be: position_error rounding() const");
  return point_source<S>;
}

}  // namespace clearance
