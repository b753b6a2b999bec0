// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A source whose points may be somewhere around the places that it gives.

#include <clearance/concepts/capsule.hpp>
#include <clearance/points/sensor_noise.hpp>
#include <clearance/points/sharded.hpp>
#include <clearance/points/solid_balls.hpp>

namespace clearance {

/// What moves all points of a cloud, besides noise. Everything is 0 or more, and finite.
struct cloud_uncertainty {
  double shift = 0, turn = 0;  ///< By how much the sensor's pose may be wrong: metres, and radians about its (0,0,0).
  double max_speed = 0;        ///< No obstacle is faster, in m/s.
  double age = 0;              ///< How old the cloud is, in seconds.
};

/// A source whose point i may be anywhere in a ball around it. The radius is that of the noise, `shift + turn |p|`
/// (from the sensor), and `max_speed * age`, rounded up. Around capsules radii add. A radius of 1e6 m, a negative one
/// and NaN say nothing: the point may be anywhere, which counts as `too_close`, and nothing is free then. A point that
/// was measured out of the source's range, or of what its crop keeps, counts if its ball reaches into it.
///
/// `min_distance` and other questions about an uncertain source are about all places where its points may be.
template <point_source S, sensor_noise N = no_noise>
struct uncertain : passes_on<uncertain<S, N>, S, sources::copied, sources::copied_in_pieces, sources::in_pieces> {
  static constexpr bool vague = true, balls = !capsule_source<S> || ball_source<S>;
  static constexpr bool surveys = surveyed_source<S> && !capsule_source<S> &&
                                  requires(const N n, extent e) { n.most(0, e); };  ///< See `surveyed_capsules`.
  using can = can_all<typename uncertain::passed, clearance::can<sources::checked, sources::capsules, sources::shared>,
                      can_if<balls, sources::slicing>, can_if<surveys, sources::surveyed_around>>;

  S source;
  N noise;
  real shift, turn, drift;  ///< Metres, radians, metres.
  real spread;              ///< More than what arithmetic and the source's rounding lose in a radius.
  static constexpr auto viewed = &uncertain::source;

  /// Throws std::invalid_argument for options that are negative or not finite.
  explicit uncertain(const S& source, const N& noise = {}, const cloud_uncertainty& of = {})
      : source(source),
        noise(noise),
        shift(rounded_up(of.shift)),
        turn(rounded_up(of.turn)),
        drift(rounded_up(of.max_speed * of.age)),
        spread(rounded_up(clearance::fma(1.5, rounding_of(source).relative, 1 + 0x1p-19))) {
    detail::check_uncertain(of.shift, "a sensor's shift");
    detail::check_uncertain(of.turn, "a sensor's turn");
    detail::check_uncertain(of.max_speed, "the obstacles' greatest speed");
    detail::check_uncertain(of.age, "a cloud's age");
    check();
    if constexpr (sharded_source<S>)
      for (std::size_t k = 1; k < source.pieces(); ++k)
        if (sensor_of(source.piece(k)) != sensor_of(source))
          throw std::invalid_argument("clearance: piece " + std::to_string(k) +
                                      " of an uncertain cloud is seen from another place than piece 0: make each "
                                      "uncertain, then the cloud of them");
  }

  /// See `rounding_of`.
  void check() const {
    detail::check_uncertain(shift, "a sensor's shift");
    detail::check_uncertain(turn, "a sensor's turn");
    detail::check_uncertain(drift, "speed times age");
    if constexpr (requires { noise.check(source.size()); }) noise.check(source.size());
  }

  CLEARANCE_HD sample operator[](std::size_t i) const {
    sample s = source[i];
    if ((s.dropped == drop_reason::out_of_range || s.dropped == drop_reason::cropped) && may_be_in_range(i, s.position))
      s.dropped = drop_reason::none;
    if (!s.valid()) return s;
    if (!bounded(radius(i, s.position))) s.dropped = drop_reason::too_close;
    return s;
  }
  /// Does a radius bound where the point is? If not, the point may be anywhere.
  CLEARANCE_HD static bool bounded(real radius) { return radius < 1e6f; }
  /// The radius of point i at p; NaN if its noise says nothing. It is no sum of products, which compilers may fuse.
  CLEARANCE_HD real radius(std::size_t i, vec3 p) const {
    const vec3 seen = p - sensor_of(source);
    const real turned = balls ? length(seen) : 0, its = noise(i, seen);
    return its >= 0 ? fma(its, spread, fma(fma(turn, turned, shift), spread, product(drift, spread))) : not_a_number;
  }
  CLEARANCE_HD capsule around(std::size_t i, vec3 p) const {
    if constexpr (capsule_source<S>) {
      capsule c = source.around(i, p);
      c.radius = c.radius + radius(i, p);
      return c;
    } else {
      return {p, {0, 0, 0}, radius(i, p)};
    }
  }
  /// What the radius of point i at p is made of. What a turn adds along a capsule is in `rounding`.
  CLEARANCE_HD radius_shares shares(std::size_t i, vec3 p) const {
    const vec3 seen = p - sensor_of(source);
    const real turned = balls ? length(seen) : 0;
    return {product(noise(i, seen), spread), product(fma(turn, turned, shift), spread), product(drift, spread)};
  }

  /// See `surveyed_capsules`; false also where some radius is unbounded.
  bool survey_capsules(std::size_t begin, extent& box, extent& ends, real& widest,
                       std::uint32_t (&dropped)[drop_reasons]) const
    requires surveys
  {
    std::uint32_t dropped_now[drop_reasons] = {};
    if (!source.survey(begin, box, dropped_now)) return false;
    if (dropped_now[int(drop_reason::out_of_range)] + dropped_now[int(drop_reason::cropped)] != 0)
      return false;                       // some of them may be in range
    if (!(box.lower.x <= box.upper.x)) {  // no point
      widest = 0;
    } else {
      const vec3 sensor = sensor_of(source);
      const extent seen{box.lower - sensor, box.upper - sensor};
      widest = (noise.most(begin, seen) + turn * detail::farthest_in(seen) + shift + drift) * spread * (1 + slack);
    }
    if (!bounded(widest)) return false;
    ends = box;
    for (int k = 0; k < drop_reasons; ++k) dropped[k] += dropped_now[k];
    return true;
  }
  /// Another source with the same uncertainty, and a noise for each of its points.
  template <point_source Other, sensor_noise Its>
  uncertain<Other, Its> around_same(const Other& other, const Its& its) const {
    uncertain<Other, Its> same(other, its);
    same.shift = shift;
    same.turn = turn;
    same.drift = drift;
    return same;
  }
  /// Points `begin` to `end - 1`, each with its own radius.
  auto slice(std::size_t begin, std::size_t end) const
    requires balls
  {
    return around_same(clearance::slice(source, begin, end), clearance::slice(noise, begin, end));
  }
  /// Piece k of a `sharded` source, with the same uncertainty.
  auto piece(std::size_t k) const
    requires sharded_source<S>
  {
    return around_same(source.piece(k), clearance::slice(noise, source.first(k), source.first(k + 1)));
  }
  position_error rounding() const {
    position_error own = rounding_of(source);
    if constexpr (!balls) own.relative += double(turn);
    return own;
  }

 private:
  /// Is the range within the radius of a point that was measured beyond it? Without a radius it is not.
  CLEARANCE_HD bool may_be_in_range(std::size_t i, vec3 p) const {
    const real by = beyond_range(source, i, p);
    if (!(by < infinity)) return false;
    const real off = balls ? 0 : turn * length(p - sensor_of(source)), reach = radius(i, p) + off;
    return !(reach <= 0) && !(reach * (1 + slack) + slack * length(p) < by);
  }
};

/// The places that a source gives, without what is uncertain about them.
struct as_measured {
  template <point_source S>
  CLEARANCE_HD S operator()(const S& s) const {
    return s;
  }
  template <point_source S, sensor_noise N>
  CLEARANCE_HD S operator()(const uncertain<S, N>& s) const {
    return s.source;
  }
  template <vague_source S>
  auto operator()(const sliced<S>& s) const {
    return sliced((*this)(s.whole), s.begin, s.count);
  }
  template <vague_source S>
  auto operator()(const sharded<S>& s) const {
    std::vector<decltype((*this)(s.piece(0)))> pieces;
    for (std::size_t k = 0; k < s.pieces(); ++k) pieces.push_back((*this)(s.piece(k)));
    return sharded(pieces);
  }
};

/// The same cloud, in which full balls are larger by their gap, and so contain what they fill. Throws
/// std::invalid_argument about a user's own balls that have a gap, but no `filled()`.
struct as_filled {
  template <point_source S>
  S operator()(const S& s) const {
    if constexpr (requires { s.filled(); }) {
      return s.filled();
    } else if constexpr (!ball_source<S>) {
      return s;
    } else if constexpr (requires { S::viewed; }) {
      S same = s;
      same.*S::viewed = (*this)(s.*S::viewed);
      return same;
    } else if constexpr (sharded_source<S>) {
      return s.with_pieces(*this);
    } else {
      if (rounding_of(s).gap > 0)
        detail::refuse_source(
            "a cloud of full balls has a gap, and its source has no filled(), which gives the balls larger by it");
      return s;
    }
  }
};

/// What a source says about the radius of its point i at p.
template <point_source S>
CLEARANCE_HD radius_shares shares_of(const S& s, std::size_t i, vec3 p) {
  if constexpr (shared_source<S>)
    return s.shares(i, p);
  else
    return {};
}

}  // namespace clearance
