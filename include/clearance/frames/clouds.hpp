// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds with their poses, of one kind or of many, and how their points are numbered.

#include <clearance/concepts/capsule.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/points/arrays.hpp>

#include <stdexcept>
#include <string>
#include <tuple>
#include <variant>

namespace clearance {

/// A point source, or that of an array of points, and its pose, world-from-source.
template <point_source S>
struct placed {
  S source;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  placed() = default;
  placed(const S& source, const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) : source(source), pose(pose) {}
  template <point_container C>
    requires std::is_same_v<points_in<C>, S>
  placed(const C& points CLEARANCE_LIFETIMEBOUND, const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity())
      : source(points_of(points)), pose(pose) {}
  template <owning_points C>
  placed(const C&&, const Eigen::Isometry3d& = Eigen::Isometry3d::Identity()) = delete;  // its points would be gone
};
template <point_container C>
placed(const C&) -> placed<points_in<C>>;
template <point_container C>
placed(const C&, const Eigen::Isometry3d&) -> placed<points_in<C>>;

namespace detail {

template <class T>
struct is_cloud : std::bool_constant<point_source<T> || point_container<T>> {};
template <point_source S>
struct is_cloud<placed<S>> : std::true_type {};
template <class... T>
struct is_cloud<std::tuple<T...>> : std::bool_constant<(is_cloud<T>::value && ...)> {};
template <class... T>
struct is_cloud<std::variant<T...>> : std::bool_constant<(is_cloud<T>::value && ...)> {};
template <class T>
  requires(!point_source<T> && !point_container<T>) && requires(const T t) { std::begin(t); }
struct is_cloud<T> : is_cloud<std::remove_cvref_t<decltype(*std::begin(std::declval<const T&>()))>> {};

template <class T>
inline constexpr bool one_in_each_place = false;
template <class T>
  requires(!point_source<T> && !point_container<T>) && requires(const T t) { std::begin(t), std::size(t); }
inline constexpr bool one_in_each_place<T> =
    requires(std::remove_cvref_t<decltype(*std::begin(std::declval<const T&>()))> cloud) { cloud.source, cloud.pose; };

/// Are some clouds in a device's memory?
template <class T>
inline constexpr bool some_on_device = only_on_device<T>();
template <point_container C>
inline constexpr bool some_on_device<C> = only_on_device<points_in<C>>();
template <point_source S>
inline constexpr bool some_on_device<placed<S>> = only_on_device<S>();
template <class... T>
inline constexpr bool some_on_device<std::tuple<T...>> = (some_on_device<T> || ...);
template <class... T>
inline constexpr bool some_on_device<std::variant<T...>> = (some_on_device<T> || ...);
template <class T>
  requires(!point_source<T> && !point_container<T>) && requires(const T t) { std::begin(t); }
inline constexpr bool some_on_device<T> =
    some_on_device<std::remove_cvref_t<decltype(*std::begin(std::declval<const T&>()))>>;

}  // namespace detail

/// What callers may pass as clouds: a source, a placed one or an array of points; a range, tuple or variant of these.
template <class T>
concept clouds_of_any_kind = detail::is_cloud<T>::value;

/// Calls `f(source, pose)` for each cloud, in order.
template <clouds_of_any_kind Clouds, class F>
void for_each_cloud(const Clouds& clouds, F&& f) {
  static const Eigen::Isometry3d unmoved = Eigen::Isometry3d::Identity();
  if constexpr (point_source<Clouds>) {
    f(detail::read_here(clouds), unmoved);
  } else if constexpr (requires { clouds.source, clouds.pose; }) {
    f(detail::read_here(clouds.source), clouds.pose);
  } else if constexpr (point_container<Clouds>) {
    const auto source = points_of(clouds);
    f(detail::read_here(source), unmoved);
  } else if constexpr (requires { std::tuple_size<Clouds>::value; }) {
    std::apply([&](const auto&... each) { (for_each_cloud(each, f), ...); }, clouds);
  } else if constexpr (requires { std::variant_size<Clouds>::value; }) {
    std::visit([&](const auto& it) { for_each_cloud(it, f); }, clouds);
  } else {
    for (const auto& cloud : clouds) for_each_cloud(cloud, f);
  }
}

/// The number of clouds. A range that knows its size and holds one cloud per element is not read: reading may load one.
template <class Clouds>
std::size_t count_clouds(const Clouds& clouds) {
  if constexpr (detail::one_in_each_place<Clouds>) return std::size(clouds);
  std::size_t n = 0;
  for_each_cloud(clouds, [&](const auto&, const Eigen::Isometry3d&) { ++n; });
  return n;
}

/// The number of points of all clouds.
template <class Clouds>
std::size_t count_points(const Clouds& clouds) {
  std::size_t points = 0;
  for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) { points += source.size(); });
  return points;
}

/// May the points of some cloud be elsewhere? Then no point is certainly anywhere.
template <class Clouds>
bool any_vague(const Clouds& clouds) {
  bool some = false;
  for_each_cloud(clouds, [&]<class S>(const S&, const Eigen::Isometry3d&) { some = some || vague_source<S>; });
  return some;
}

namespace detail {
template <template <class...> class Many, class... T>
consteval bool explain_each(std::type_identity<Many<T...>>);
}  // namespace detail

/// `clouds_of_any_kind<T>` with reasons, and with what else its sources have.
template <class T>
consteval bool explain_clouds() {
  if constexpr (point_source<T>)
    explain_point_source<T>();
  else if constexpr (requires(const T t) { t.source, t.pose; })
    explain_point_source<std::remove_cvref_t<decltype(std::declval<const T&>().source)>>();
  else if constexpr (point_container<T>)
    return true;
  else if constexpr (requires(const T t) { *std::begin(t); })
    explain_clouds<std::remove_cvref_t<decltype(*std::begin(std::declval<const T&>()))>>();
  else if constexpr (requires { std::tuple_size<T>::value; } || requires { std::variant_size<T>::value; })
    detail::explain_each(std::type_identity<T>());
  else if constexpr (requires(const T t) {
                       t.size();
                       t[0];
                     })
    explain_point_source<T>();
  else
    static_assert(
        clouds_of_any_kind<T>,
        "clouds are: a point source, a placed one, a vector of vec3; or a range, a tuple or variants of those");
  return clouds_of_any_kind<T>;
}
template <template <class...> class Many, class... T>
consteval bool detail::explain_each(std::type_identity<Many<T...>>) {
  return (explain_clouds<T>() && ...);
}
/// `explain_clouds` of everything that a call is given as clouds: one argument, or a source and its pose.
template <class First, class... Rest>
consteval bool explain_given() {
  constexpr bool fits = sizeof...(Rest) == 0 ||
                        (sizeof...(Rest) == 1 && (std::is_convertible_v<const Rest&, const Eigen::Isometry3d&> && ...));
  static_assert(fits,
                "several clouds are a vector or a tuple of placed ones, and one may be followed by its pose, an "
                "Eigen::Isometry3d");
  if constexpr (!fits)
    return false;
  else if constexpr (point_container<First>)
    return true;
  else if constexpr (sizeof...(Rest) == 1)
    return explain_point_source<First>();
  else
    return explain_clouds<First>();
}

/// The clouds of a call, as they were given. A source and its pose become a placed source.
template <class Clouds>
const Clouds& as_clouds(const Clouds& clouds) {
  static_assert(explain_given<Clouds>());
  return clouds;
}
template <class S, class Pose>
auto as_clouds(const S& source, const Pose& pose) {
  static_assert(explain_given<S, Pose>());
  return placed{source, pose};
}

namespace frames {

/// Throws std::invalid_argument if there is not one minimum per part.
inline void check_room(std::size_t parts, std::size_t minima) {
  if (minima != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but room for " +
                                std::to_string(minima) + " minima");
}

/// One cloud of a frame: its number, that of its first point among all clouds' points, and whether it is the last.
struct turn {
  std::uint32_t cloud, first;
  bool last;
};

/// Goes through a frame cloud by cloud: places the parts in each and calls `f(source, turn)`; without clouds, once with
/// no points. Returns the number of points. Throws std::invalid_argument if the number of poses is wrong, a pose is not
/// rigid, or there are more than 2^32 - 2 points.
template <class Clouds, class F>
std::uint64_t for_each_turn(cloud_frame& frame, std::span<const part_facts> facts,
                            std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, F f) {
  static_assert(explain_clouds<Clouds>());
  frame.start(facts, poses);
  const std::size_t count = count_clouds(clouds);
  std::uint64_t points = 0;
  std::uint32_t cloud = 0;
  const auto next = [&](const auto& source, const Eigen::Isometry3d& pose) {
    const std::uint64_t size = source.size();
    if (size >= ~std::uint32_t(0) - points)
      throw std::invalid_argument("clearance: more than 2^32 - 2 points in one call");
    frame.put(facts, pose, cloud, rounding_of(source));
    f(source, turn{cloud, std::uint32_t(points), cloud + 1 >= count});
    ++cloud;
    points += size;
  };
  if (count == 0) next(point_span{}, Eigen::Isometry3d::Identity());
  for_each_cloud(clouds, next);
  return points;
}

}  // namespace frames

}  // namespace clearance
