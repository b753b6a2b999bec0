// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where points come from, and what makes reading them fast.

#include <clearance/ground/can.hpp>
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
/// nothing is `free` then. `cropped`: it is no obstacle by its place.
enum class drop_reason : std::uint8_t {
  none,
  not_finite,
  missing,
  saturated,
  out_of_range,
  masked,
  too_close,
  cropped
};
inline constexpr int drop_reasons = 8;

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

/// A box around points; empty (lower > upper) if there are none.
struct extent {
  vec3 lower = {infinity, infinity, infinity}, upper = {-infinity, -infinity, -infinity};

  CLEARANCE_HD void add(vec3 p) {
    lower = {min(lower.x, p.x), min(lower.y, p.y), min(lower.z, p.z)};
    upper = {max(upper.x, p.x), max(upper.y, p.y), max(upper.z, p.z)};
  }
};

/// How far from its point a position may be: at most `absolute + relative * (its distance from the source's (0,0,0))`,
/// in metres. It covers what was lost before the source was made, and what is lost when it is read. The bracket of
/// every distance carries it. What points stand for may also be nearer, by `gap` metres: lower ends carry that.
struct position_error {
  double absolute = 0, relative = 0;
  double gap = 0;  ///< Infinite: nothing is certain.
};

struct capsule;     // concepts/capsule.hpp
struct point_tile;  // points/tile.hpp

// All that a source may have besides, from here to `sources::known`: each with its law, its signature, and its name in
// the list that a source may have: `using can = clearance::can<clearance::sources::fetched, ...>`. What has one of the
// names must have its signature. With a list, what is in it must be there, and what is there must be in it.

/// Asks a source S about one member. A function that S's own constraints take away is not there: so an adaptor has what
/// its source has.
#define CLEARANCE_SOURCE_MEMBER(ABILITY, MEMBER, RIGHT, SIGNATURE)                                                   \
  static_assert(RIGHT || !lists<S, ABILITY>, "a point source that lists sources::" #ABILITY " needs: " SIGNATURE);   \
  static_assert(                                                                                                     \
      RIGHT || lists<S, ABILITY> || !requires { requires std::is_member_function_pointer_v<decltype(&S::MEMBER)>; }, \
      "what a point source has by the name " #MEMBER " must be: " SIGNATURE);                                        \
  static_assert(!RIGHT || !has_list<S> || lists<S, ABILITY>,                                                         \
                "a point source has " #MEMBER ", but its list can<...> does not name sources::" #ABILITY)
/// One of an ability's members: an expression of this type, about a source s.
#define CLEARANCE_SOURCE_HAS(ABILITY, MEMBER, SIGNATURE, TYPE, ...)                                  \
  {                                                                                                  \
    constexpr bool right = requires(const S s, std::size_t i, const std::byte* copy, vec3(&at)[4]) { \
      { __VA_ARGS__ } -> std::same_as<TYPE>;                                                         \
    };                                                                                               \
    CLEARANCE_SOURCE_MEMBER(ABILITY, MEMBER, right, SIGNATURE);                                      \
  }
/// Declares an ability: the concept, and what explains its members.
#define CLEARANCE_SOURCE_ABILITY(ABILITY, CONCEPT, ...) \
  namespace sources {                                   \
  struct ABILITY;                                       \
  }                                                     \
  struct sources::ABILITY {                             \
    template <class S>                                  \
    static constexpr bool of = CONCEPT<S>;              \
    template <class S>                                  \
    static consteval bool explain() {                   \
      __VA_ARGS__;                                      \
      return true;                                      \
    }                                                   \
  }
/// One with a single member.
#define CLEARANCE_SOURCE_CAN(ABILITY, MEMBER, CONCEPT, SIGNATURE) \
  CLEARANCE_SOURCE_ABILITY(ABILITY, CONCEPT, CLEARANCE_SOURCE_MEMBER(ABILITY, MEMBER, CONCEPT<S>, SIGNATURE))

/// A source that says, on a host, how far its positions may be from their points. Others are exact.
template <class S>
concept rounded_source = point_source<S> && requires(const S s) {
  { s.rounding() } -> std::same_as<position_error>;
};
CLEARANCE_SOURCE_CAN(rounded, rounding, rounded_source, "position_error rounding() const");

/// A source that looks at itself on a host, before a point is read.
/// Law: `check()` throws std::invalid_argument if its numbers contradict one another.
template <class S>
concept checked_source = point_source<S> && requires(const S s) {
  { s.check() } -> std::same_as<void>;
};
CLEARANCE_SOURCE_CAN(checked, check, checked_source, "void check() const");

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
CLEARANCE_SOURCE_ABILITY(
    fetched, fetched_source,
    CLEARANCE_SOURCE_HAS(fetched, fetches, "CLEARANCE_HD bool fetches() const", bool, s.fetches());
    CLEARANCE_SOURCE_HAS(fetched, seek, "CLEARANCE_HD cursor seek(std::size_t i) const, with a type cursor",
                         typename S::cursor, s.seek(i));
    CLEARANCE_SOURCE_HAS(fetched, skip, "CLEARANCE_HD cursor skip(const cursor&, std::size_t n) const",
                         typename S::cursor, s.skip(std::declval<const typename S::cursor&>(), i));
    CLEARANCE_SOURCE_HAS(fetched, fetch, "CLEARANCE_HD four fetch(const cursor&) const, with a type four",
                         typename S::four, s.fetch(std::declval<const typename S::cursor&>()));
    CLEARANCE_SOURCE_HAS(fetched, look, "CLEARANCE_HD unsigned look(const four&, std::size_t i, vec3 (&at)[4]) const",
                         unsigned, s.look(std::declval<const typename S::four&>(), i, at)));

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
CLEARANCE_SOURCE_CAN(surveyed, survey, surveyed_source,
                     "bool survey(std::size_t begin, extent&, std::uint32_t (&dropped)[drop_reasons]) const");

/// A source that fills in 128 places itself.
/// Law: `read(begin, count, stride, tile, dropped)` does what `tile.read(s, begin, count, stride, dropped)` does.
template <class S>
concept read_source =
    point_source<S> && requires(const S s, std::size_t n, point_tile& tile, std::uint32_t (&dropped)[drop_reasons]) {
      { s.read(n, n, n, tile, dropped) } -> std::same_as<void>;
    };
CLEARANCE_SOURCE_CAN(read, read, read_source,
                     "void read(std::size_t begin, std::size_t count, std::size_t stride, point_tile&, std::uint32_t "
                     "(&dropped)[drop_reasons]) const");

/// A source that says when it filters nothing: then every point with finite coordinates counts, and every position can
/// be read.
template <class S>
concept unfiltered_source = point_source<S> && requires(const S s) {
  { s.unfiltered() } -> std::same_as<bool>;
};
CLEARANCE_SOURCE_CAN(unfiltered, unfiltered, unfiltered_source, "CLEARANCE_HD bool unfiltered() const");

/// A source whose points are an image's, row by row: neighbours above one another are neighbours too.
///
/// Law: `columns()` is the number of points in a row.
template <class S>
concept image_source = point_source<S> && requires(const S s) {
  { s.columns() } -> std::same_as<std::uint32_t>;
};
CLEARANCE_SOURCE_CAN(image, columns, image_source, "std::uint32_t columns() const");

/// A source of points in some range.
/// Law: `beyond(i, p)` is not more metres than p, where point i is `out_of_range` or `cropped`, is from the places that
/// count. Without it such a point is out, however uncertain it is.
template <class S>
concept ranged_source = point_source<S> && requires(const S s, std::size_t i, vec3 p) {
  { s.beyond(i, p) } -> std::same_as<real>;
};
CLEARANCE_SOURCE_CAN(ranged, beyond, ranged_source, "CLEARANCE_HD real beyond(std::size_t i, vec3 p) const");

/// A source whose points are seen from `sensor()`, in its frame. Those of others are seen from (0,0,0).
template <class S>
concept seen_source = point_source<S> && requires(const S s) {
  { s.sensor() } -> std::same_as<vec3>;
};
CLEARANCE_SOURCE_CAN(seen, sensor, seen_source, "CLEARANCE_HD vec3 sensor() const");

/// A source with a `point_filter`, which says its range and its sensor.
template <class S>
concept filtered_source = point_source<S> && requires(const S s, vec3 p) {
  { s.filter.beyond(p) } -> std::same_as<real>;
  { (s.filter.sensor) } -> std::same_as<const vec3&>;
};
CLEARANCE_SOURCE_CAN(filtered, filter, filtered_source, "point_filter filter");

/// What lies in ordinary host memory, of which a device makes copies.
/// Law: `bytes()` is the memory that is read, and `at(copy)` the same over a copy of it.
template <class S>
concept copied_memory = requires(const S s, const std::byte* copy) {
  { s.bytes() } -> std::same_as<std::span<const std::byte>>;
  { s.at(copy) } -> std::same_as<S>;
};
/// A source in such memory. Optional: `bytes(begin, end)`, what points `begin` to `end - 1` need of it.
template <class S>
concept copied_source = point_source<S> && copied_memory<S>;
CLEARANCE_SOURCE_ABILITY(copied, copied_source,
                         CLEARANCE_SOURCE_HAS(copied, bytes, "std::span<const std::byte> bytes() const",
                                              std::span<const std::byte>, s.bytes());
                         CLEARANCE_SOURCE_HAS(copied, at, "its own type at(const std::byte* copy) const", S,
                                              s.at(copy)));

/// A source that makes a source of some of its points itself, better than `sliced` would.
/// Law: point i of `slice(begin, end)` is point `begin + i`, and there are `end - begin`.
template <class S>
concept slicing_source = point_source<S> && requires(const S s, std::size_t i) {
  { s.slice(i, i) } -> point_source;
};
CLEARANCE_SOURCE_CAN(slicing, slice, slicing_source, "a point source slice(std::size_t begin, std::size_t end) const");

/// A source that is made of pieces.
/// Law: point i of `piece(k)` is point `first(k) + i`; `first(pieces())` is the number of points.
template <class S>
concept sharded_source = point_source<S> && requires(const S s, std::size_t k) {
  { s.pieces() } -> std::same_as<std::size_t>;
  { s.first(k) } -> std::same_as<std::size_t>;
  requires point_source<std::remove_cvref_t<decltype(s.piece(k))>>;
};
CLEARANCE_SOURCE_ABILITY(in_pieces, sharded_source,
                         CLEARANCE_SOURCE_HAS(in_pieces, pieces, "std::size_t pieces() const", std::size_t, s.pieces());
                         CLEARANCE_SOURCE_HAS(in_pieces, first, "std::size_t first(std::size_t k) const", std::size_t,
                                              s.first(i));
                         CLEARANCE_SOURCE_HAS(in_pieces, piece, "a point source piece(std::size_t k) const", sample,
                                              s.piece(i)[i]));

namespace detail {
struct same_piece {
  template <class S>
  const S& operator()(const S& piece) const {
    return piece;
  }
};
}  // namespace detail

/// A source whose points lie in several pieces of memory.
/// Law: `with_pieces(f)` is the same source with `f(piece)` in place of each, a source or `copied_memory`.
template <class S>
concept source_in_pieces = point_source<S> && requires(const S s) {
  { s.with_pieces(detail::same_piece{}) } -> std::same_as<S>;
};
CLEARANCE_SOURCE_CAN(copied_in_pieces, with_pieces, source_in_pieces, "its own type with_pieces(const auto& f) const");

/// A source whose points stand for capsules. Its constants say more: `vague`, `balls` and `sight`
/// (concepts/capsule.hpp).
/// Law: `around(i, s[i].position)` starts there, and is finite.
template <class S>
concept capsule_source = point_source<S> && requires(const S s, std::size_t i, vec3 p) {
  { s.around(i, p) } -> std::same_as<capsule>;
};
CLEARANCE_SOURCE_CAN(capsules, around, capsule_source, "CLEARANCE_HD capsule around(std::size_t i, vec3 p) const");

/// A source that says where the capsules of 128 neighbours are, without taking them apart; see `surveyed_source`.
/// Law: if it is true, starts and ends are in those boxes, and no radius is above `widest`.
template <class S>
concept surveyed_capsules = capsule_source<S> && requires(const S s, std::size_t begin, extent& box, real& widest,
                                                          std::uint32_t (&dropped)[drop_reasons]) {
  { s.survey_capsules(begin, box, box, widest, dropped) } -> std::same_as<bool>;
};
CLEARANCE_SOURCE_CAN(surveyed_around, survey_capsules, surveyed_capsules,
                     "bool survey_capsules(std::size_t begin, extent& starts, extent& ends, real& widest, "
                     "std::uint32_t (&dropped)[drop_reasons]) const");

/// What of a point's radius comes from where. Metres.
struct radius_shares {
  real noise = 0, calibration = 0, time = 0;

  CLEARANCE_HD real sum() const { return noise + calibration + time; }
};

/// A source that says what the radius of its point i at p comes from.
template <class S>
concept shared_source = point_source<S> && requires(const S s, std::size_t i, vec3 p) {
  { s.shares(i, p) } -> std::same_as<radius_shares>;
};
CLEARANCE_SOURCE_CAN(shared, shares, shared_source, "CLEARANCE_HD radius_shares shares(std::size_t i, vec3 p) const");

/// An image whose pixels can be asked for more than a point.
/// Law: pixel i looks along `way(i)`, whose z is 1. `depth(i)` is what it holds in metres, even if that is no depth.
template <class S>
concept seeing_image = point_source<S> && requires(const S s, std::size_t i) {
  { s.way(i) } -> std::same_as<vec3>;
  { s.depth(i) } -> std::same_as<real>;
};
CLEARANCE_SOURCE_ABILITY(seeing, seeing_image,
                         CLEARANCE_SOURCE_HAS(seeing, way, "CLEARANCE_HD vec3 way(std::size_t i) const", vec3,
                                              s.way(i));
                         CLEARANCE_SOURCE_HAS(seeing, depth, "CLEARANCE_HD real depth(std::size_t i) const", real,
                                              s.depth(i)));

namespace sources {

/// Is there nothing amiss with what S has and lists?
template <class S>
consteval bool known() {
  return explain_abilities<S, rounded, checked, fetched, surveyed, read, unfiltered, image, ranged, seen, filtered,
                           copied, slicing, in_pieces, copied_in_pieces, capsules, surveyed_around, shared, seeing>();
}
}  // namespace sources
#undef CLEARANCE_SOURCE_CAN
#undef CLEARANCE_SOURCE_ABILITY
#undef CLEARANCE_SOURCE_HAS
#undef CLEARANCE_SOURCE_MEMBER

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

/// A source's `rounding()`. Every question asks this of every cloud before it reads a point. So it also calls
/// `check()`, and throws std::invalid_argument itself for an error that is negative or not finite, or such a gap.
template <point_source S>
position_error rounding_of(const S& source) {
  if constexpr (checked_source<S>) source.check();
  if constexpr (rounded_source<S>) {
    const position_error its = source.rounding();
    for (const double x : {its.absolute, its.relative})
      if (!(x >= 0 && x < double(infinity)))
        detail::refuse_source("a cloud's points are off by up to " + std::to_string(its.absolute) + " m and by " +
                              std::to_string(its.relative) + " of their distance, which must be finite and 0 or more");
    if (!(its.gap >= 0))
      detail::refuse_source("the gap of a cloud is " + std::to_string(its.gap) + " m, which must be 0 or more");
    return its;
  } else {
    return {};
  }
}

/// How far p, where point i of a source is `out_of_range` or `cropped`, is from what counts, in metres: not more than
/// it is. Infinite if neither the source nor its filter says: such a point is out, however uncertain it is.
template <point_source S>
CLEARANCE_HD real beyond_range(const S& s, std::size_t i, vec3 p) {
  if constexpr (ranged_source<S>)
    return s.beyond(i, p);
  else if constexpr (filtered_source<S>)
    return s.filter.beyond(p);
  else
    return infinity;
}

/// Where a source's points are seen from, in its frame: (0,0,0), or where it or its filter has the sensor.
template <point_source S>
CLEARANCE_HD vec3 sensor_of(const S& s) {
  if constexpr (seen_source<S>)
    return s.sensor();
  else if constexpr (filtered_source<S>)
    return s.filter.sensor;
  else
    return {0, 0, 0};
}

/// `point_source<S>` with reasons, and with what else the source has.
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
  if constexpr (point_source<S>) return sources::known<S>();
  return false;
}

}  // namespace clearance
