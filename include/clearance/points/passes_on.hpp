// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A source over another one's points: what it only passes on.

#include <clearance/concepts.hpp>

namespace clearance {

namespace detail {

/// Lists, one after another.
template <class... Lists>
struct joined {
  using type = can<>;
};
template <class... A>
struct joined<can<A...>> {
  using type = can<A...>;
};
template <class... A, class... B, class... More>
struct joined<can<A...>, can<B...>, More...> : joined<can<A..., B...>, More...> {};

/// Is a source in a device's memory, which a host must not read? Its type says so, or that of the source under it.
template <class S>
consteval bool only_on_device() {
  if constexpr (requires { S::only_on_device; })
    return S::only_on_device;
  else
    return false;
}

/// What is read ahead of a source, if it can be.
struct nothing_fetched {};
template <class S>
struct fetched_types {
  using cursor = nothing_fetched;
  using four = nothing_fetched;
};
template <fetched_source S>
struct fetched_types<S> {
  using cursor = typename S::cursor;
  using four = typename S::four;
};

}  // namespace detail

/// The abilities among `Abilities` that S has.
template <class S, class... Abilities>
using can_as = typename detail::joined<std::conditional_t<Abilities::template of<S>, can<Abilities>, can<>>...>::type;
/// `Abilities` if the condition holds, else none.
template <bool If, class... Abilities>
using can_if = std::conditional_t<If, can<Abilities...>, can<>>;
/// The abilities of all lists together.
template <class... Lists>
using can_all = typename detail::joined<Lists...>::type;

/// The base of a source over another one, S: it passes on the size, what is uncertain about places, range and sensor,
/// and those of the abilities `Passed` that S has. `Self` says what it changes; it says which member S is,
/// `static constexpr auto viewed = &Self::source;`, and how S numbers its points, if otherwise: `number_in_viewed`.
template <class Self, point_source S, class... Passed>
struct passes_on {
  using passed = can_all<can<sources::rounded, sources::ranged, sources::seen>, can_as<S, Passed...>>;
  template <class Ability>
  static constexpr bool passes = passed::template has<Ability>;
  static constexpr bool only_on_device = detail::only_on_device<S>();
  using cursor = typename detail::fetched_types<S>::cursor;
  using four = typename detail::fetched_types<S>::four;

  CLEARANCE_HD std::size_t number_in_viewed(std::size_t i) const { return i; }

  CLEARANCE_HD std::size_t size() const { return under().size(); }
  position_error rounding() const { return rounding_of(under()); }
  CLEARANCE_HD real beyond(std::size_t i, vec3 p) const { return beyond_range(under(), number(i), p); }
  CLEARANCE_HD vec3 sensor() const { return sensor_of(under()); }

  CLEARANCE_HD bool fetches() const
    requires passes<sources::fetched>
  {
    return under().fetches();
  }
  CLEARANCE_HD cursor seek(std::size_t i) const
    requires passes<sources::fetched>
  {
    return under().seek(number(i));
  }
  CLEARANCE_HD cursor skip(const cursor& c, std::size_t n) const
    requires passes<sources::fetched>
  {
    return under().skip(c, n);
  }
  CLEARANCE_HD four fetch(const cursor& c) const
    requires passes<sources::fetched>
  {
    return under().fetch(c);
  }
  CLEARANCE_HD unsigned look(const four& f, std::size_t i, vec3 (&at)[4]) const
    requires passes<sources::fetched>
  {
    return under().look(f, number(i), at);
  }

  CLEARANCE_HD bool unfiltered() const
    requires passes<sources::unfiltered>
  {
    return under().unfiltered();
  }
  bool survey(std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) const
    requires passes<sources::surveyed>
  {
    return under().survey(number(begin), box, dropped);
  }

  CLEARANCE_HD capsule around(std::size_t i, vec3 p) const
    requires passes<sources::capsules>
  {
    return under().around(number(i), p);
  }
  bool survey_capsules(std::size_t begin, extent& starts, extent& ends, real& widest,
                       std::uint32_t (&dropped)[drop_reasons]) const
    requires passes<sources::surveyed_around>
  {
    return under().survey_capsules(number(begin), starts, ends, widest, dropped);
  }

  std::size_t pieces() const
    requires passes<sources::in_pieces>
  {
    return under().pieces();
  }
  std::size_t first(std::size_t k) const
    requires passes<sources::in_pieces>
  {
    return under().first(k);
  }

  std::span<const std::byte> bytes() const
    requires passes<sources::copied>
  {
    return under().bytes();
  }
  Self at(const std::byte* copy) const
    requires passes<sources::copied>
  {
    return over(under().at(copy));
  }
  template <class F>
  Self with_pieces(const F& f) const
    requires passes<sources::copied_in_pieces>
  {
    return over(under().with_pieces(f));
  }

 private:
  CLEARANCE_HD const Self& self() const { return static_cast<const Self&>(*this); }
  CLEARANCE_HD const S& under() const { return self().*Self::viewed; }
  CLEARANCE_HD std::size_t number(std::size_t i) const { return self().number_in_viewed(i); }
  Self over(const S& other) const {
    Self same = self();
    same.*Self::viewed = other;
    return same;
  }
};

}  // namespace clearance
