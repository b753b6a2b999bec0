// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Balls as a cloud. Each is full, as an inner sphere of another robot is; together they fill a solid to within a gap.

#include <clearance/concepts/capsule.hpp>
#include <clearance/points/arrays.hpp>
#include <clearance/points/sensor_noise.hpp>

namespace clearance {

/// A source of centres, each with a radius in metres.
template <class S>
concept sized_source = point_source<S> && requires(const S s, std::size_t i) {
  { s.radius(i) } -> std::same_as<real>;
};

/// Records of any size with a centre, three floats one after another or not, and a radius. Metres.
struct ball_records {
  using can = clearance::can<sources::copied, sources::slicing, sources::checked>;

  const std::byte* data = nullptr;
  std::size_t count = 0;
  std::uint32_t step = 0;                               ///< Bytes from one record to the next.
  std::uint32_t offset[3] = {0, 4, 8}, radius_at = 12;  ///< Where x, y, z and the radius begin, bytes.

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD sample operator[](std::size_t i) const {
    const std::byte* const record = data + i * step;
    return point_filter{}({load(record + offset[0]), load(record + offset[1]), load(record + offset[2])});
  }
  CLEARANCE_HD real radius(std::size_t i) const { return load(data + i * step + radius_at); }
  ball_records slice(std::size_t begin, std::size_t end) const {
    ball_records some = *this;
    some.data += begin * step;
    some.count = end - begin;
    return some;
  }

  std::span<const std::byte> bytes() const { return {data, count * step}; }
  ball_records at(const std::byte* copy) const {
    ball_records moved = *this;
    moved.data = copy;
    return moved;
  }
  /// See `rounding_of`.
  void check() const {
    if (data == nullptr && count != 0)
      detail::refuse_source("a cloud of " + std::to_string(count) + " balls has none: they are null");
  }

 private:
  CLEARANCE_HD static real load(const std::byte* from) { return read_only(reinterpret_cast<const real*>(from)); }
};

/// A source's points with their radii in an array beside it.
template <point_source S>
struct radii_beside : passes_on<radii_beside<S>, S, sources::surveyed> {
  static_assert(points_alone<S>());
  using can = can_all<typename radii_beside::passed,
                      clearance::can<sources::checked, sources::slicing, sources::copied_in_pieces>>;

  S source;
  const real* radii;
  std::size_t count;  ///< Of the radii.
  static constexpr auto viewed = &radii_beside::source;

  radii_beside(const S& source, const real* radii, std::size_t count) : source(source), radii(radii), count(count) {}

  CLEARANCE_HD sample operator[](std::size_t i) const { return source[i]; }
  CLEARANCE_HD real radius(std::size_t i) const { return radii[i]; }
  auto slice(std::size_t begin, std::size_t end) const {
    const auto some = clearance::slice(source, begin, end);
    return radii_beside<std::remove_const_t<decltype(some)>>(some, radii + begin, end - begin);
  }
  /// See `source_in_pieces`.
  template <class F>
  radii_beside with_pieces(const F& f) const {
    return {f(source), f(coordinate_arrays::column{radii, count}).values, count};
  }
  /// See `rounding_of`.
  void check() const {
    if (count != source.size())
      detail::refuse_source("there are " + std::to_string(source.size()) + " balls, but " + std::to_string(count) +
                            " radii");
    if (radii == nullptr && count != 0)
      detail::refuse_source("there are " + std::to_string(count) + " radii, but they are null");
  }
};

/// A source whose point i is the centre of a ball that is full. A distance to it is that to its centre less its radius,
/// below 0 if they overlap, and a ball that is certainly inside a part somewhere is a collision. The balls are inside
/// some solid, and none of its points is farther than `gap` from them: lower ends are lower by that, upper ends hold. A
/// ball whose radius is negative, NaN or at least 1e6 m may be anywhere, and counts as `too_close`. Ranges of the
/// source are about centres.
template <sized_source S>
struct solid_balls : passes_on<solid_balls<S>, S, sources::copied, sources::copied_in_pieces> {
  static_assert(points_alone<S>());
  static constexpr bool vague = false, balls = true, surveys = surveyed_source<S>;
  using can =
      can_all<typename solid_balls::passed, clearance::can<sources::checked, sources::capsules, sources::slicing>,
              can_if<surveys, sources::surveyed_around>>;

  S source;
  double gap, tolerance;  ///< Metres. By `tolerance` surfaces may be elsewhere, either way.
  real wider = 0;         ///< Added to each radius.
  static constexpr auto viewed = &solid_balls::source;

  /// Throws std::invalid_argument if a length is negative or NaN, or if the source contradicts itself.
  explicit solid_balls(const S& source, double gap = 0, double tolerance = 0)
      : source(source), gap(gap), tolerance(tolerance) {
    rounding_of(source);
    check();
  }

  /// See `rounding_of`.
  void check() const {
    if (!(gap >= 0) || !(tolerance >= 0))
      detail::refuse_source("the gap and the tolerance of balls are " + std::to_string(gap) + " m and " +
                            std::to_string(tolerance) + " m, which must be 0 or more");
  }
  position_error rounding() const {
    position_error own = rounding_of(source);
    own.absolute += tolerance;
    own.gap += gap;
    return own;
  }

  CLEARANCE_HD sample operator[](std::size_t i) const {
    sample s = source[i];
    if (s.valid() && !(source.radius(i) >= 0 && radius(i) < 1e6f)) s.dropped = drop_reason::too_close;
    return s;
  }
  CLEARANCE_HD real radius(std::size_t i) const {
    return wider == 0 ? source.radius(i) : fma(source.radius(i), 1 + slack, wider);
  }
  CLEARANCE_HD capsule around(std::size_t i, vec3 p) const { return {p, {0, 0, 0}, radius(i)}; }

  /// See `surveyed_capsules`; false also where some radius bounds nothing.
  bool survey_capsules(std::size_t begin, extent& box, extent& ends, real& widest,
                       std::uint32_t (&dropped)[drop_reasons]) const
    requires surveys
  {
    widest = detail::most_radius([&](std::size_t j) { return source.radius(begin + j); }) * (1 + slack) + wider;
    if (!(widest < 1e6f) || !source.survey(begin, box, dropped)) return false;
    ends = box;
    return true;
  }

  /// Balls `begin` to `end - 1`.
  auto slice(std::size_t begin, std::size_t end) const {
    const auto some = clearance::slice(source, begin, end);
    solid_balls<std::remove_const_t<decltype(some)>> piece(some, gap, tolerance);
    piece.wider = wider;
    return piece;
  }
  /// The balls with `gap` around them, which contain the solid.
  solid_balls filled() const {
    solid_balls same = *this;
    same.wider = rounded_up(wider + gap);
    same.gap = 0;
    return same;
  }
};

namespace detail {

/// Where a record has its centre's x, and its radius: a float `w` (CUDA's float4), `r` or `radius` beside x, y and z,
/// or `center` and `radius`.
template <class T>
constexpr std::uint32_t radius_in() {
  if constexpr (requires(const T t) { requires std::is_same_v<decltype(t.radius), real>; })
    return offsetof(T, radius);
  else if constexpr (requires(const T t) { requires std::is_same_v<decltype(t.r), real>; })
    return offsetof(T, r);
  else
    return offsetof(T, w);
}

}  // namespace detail

/// A record of a ball: x, y and z, all float, with a float `w` (CUDA's float4), `r` or `radius`; or `center` (vec3) and
/// `radius`, as `ball` and `inner_sphere`.
template <class T>
concept ball_record =
    std::is_standard_layout_v<T> && std::is_trivially_copyable_v<T> &&
    (requires(const T t) {
      requires std::is_same_v<decltype(t.center), vec3> && std::is_same_v<decltype(t.radius), real>;
    } || (xyz_record<T> && requires(const T t) { requires std::is_same_v<decltype(t.x), float>; } &&
          (requires(const T t) { requires std::is_same_v<decltype(t.w), real>; } ||
           requires(const T t) { requires std::is_same_v<decltype(t.r), real>; } ||
           requires(const T t) { requires std::is_same_v<decltype(t.radius), real>; })));

/// An array of such records, or of radii, of any library.
template <class C>
concept ball_container = requires(const C& c) {
  { std::size(c) } -> std::convertible_to<std::size_t>;
  requires ball_record<detail::pointed_to<decltype(std::data(c))>>;
};
template <class C>
concept radius_container = requires(const C& c) {
  { std::size(c) } -> std::convertible_to<std::size_t>;
  requires std::is_same_v<detail::pointed_to<decltype(std::data(c))>, real>;
};

namespace detail {

/// An array that owns what it has; a span views that of another array.
template <class C>
concept owns_balls = (ball_container<C> || point_container<C> || radius_container<C>) &&
                     !std::ranges::borrowed_range<C> && !requires { typename C::element_type; };

/// `count` records from an address on. `OnHost`: the type does not say that they are a device's.
template <bool OnHost, ball_record T>
auto balls_at(const T* first, std::size_t count, double gap, double tolerance) {
  ball_records records{reinterpret_cast<const std::byte*>(first), count, sizeof(T)};
  records.radius_at = radius_in<T>();
  if constexpr (requires(const T t) { t.center; }) {
    for (std::uint32_t& its : records.offset) its += std::uint32_t(offsetof(T, center));
  } else {
    records.offset[0] = offsetof(T, x);
    records.offset[1] = offsetof(T, y);
    records.offset[2] = offsetof(T, z);
  }
  return marked<OnHost>(solid_balls(records, gap, tolerance));
}

/// Radii that an array of the host owns are looked at once; others when they are read.
template <class C>
void check_radii_of(const C& owner, const auto& balls) {
  if constexpr (owning_range<C> && host_readable<decltype(std::data(owner))>)
    for (std::size_t i = 0; i < balls.size(); ++i)
      if (const real its = balls.radius(i); !(its >= 0 && its <= largest_real))
        refuse_source("the radius of ball " + std::to_string(i) + " is " + std::to_string(its) +
                      " m, which must be 0 or more");
}

}  // namespace detail

/// Balls in an array of any library, where they lie: of records with centre and radius, or of points beside one of
/// radii. Metres. Throws std::invalid_argument for a negative gap, for another number of radii than of centres, and for
/// a negative or infinite radius in an array that the host owns.
template <ball_container C>
auto balls_of(const C& records, double gap = 0) {
  const auto first = detail::address_of(std::data(records));
  constexpr bool on_host = detail::host_readable<decltype(std::data(records))>;
  const auto made = detail::balls_at<on_host>(first, std::size(records), gap, 0);
  detail::check_radii_of(records, made);
  return made;
}
template <point_container C, radius_container R>
auto balls_of(const C& centres, const R& radii, double gap = 0) {
  constexpr bool on_host = !detail::only_on_device<points_in<C>>() && detail::host_readable<decltype(std::data(radii))>;
  const solid_balls made(
      radii_beside(detail::read_here(points_of(centres)), detail::address_of(std::data(radii)), std::size(radii)), gap);
  detail::check_radii_of(radii, made);
  return detail::marked<on_host>(made);
}
template <class C, class... More>
  requires detail::owns_balls<C>
void balls_of(const C&&, const More&...) = delete;  // the balls would be gone before they are read; name them
template <class C, class R, class... More>
  requires detail::owns_balls<R>
void balls_of(const C&, const R&&, const More&...) = delete;  // the same, of radii

}  // namespace clearance
