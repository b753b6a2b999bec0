// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One source of each kind, all before one robot, and which of them a question takes.

#include "support/scenes.hpp"

#include <clearance/points/depth_image.hpp>
#include <clearance/points/hidden.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/query/combination.hpp>

#include <variant>
#include <vector>

namespace combinations {

using namespace testing;
using clearance::form, clearance::placed;

/// A source of a user's own with the least that it needs: samples that lie somewhere.
struct listed_samples {
  const clearance::sample* samples = nullptr;
  std::size_t count = 0;
  clearance::position_error off = {};

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD clearance::sample operator[](std::size_t i) const { return samples[i]; }
  clearance::position_error rounding() const { return off; }
};

/// A radius that depends on the number of the point, or none.
struct some_radius {
  real each = 0;
  CLEARANCE_HD real operator()(std::size_t i, vec3) const { return each * real(i % 7); }
};

using points = clearance::point_span;
using image = clearance::depth_image<std::uint16_t>;
using balls = clearance::uncertain<points, some_radius>;
using full_balls = clearance::solid_balls<clearance::radii_beside<points>>;
using uncertain_image = clearance::uncertain<image, some_radius>;
using room = clearance::hidden<image>;
using uncertain_room = clearance::uncertain<room, some_radius>;

template <class... S>
struct kinds {};
using all_kinds = kinds<points, image, listed_samples, balls, full_balls, uncertain_image, room, uncertain_room>;

template <class S>
inline constexpr const char* name_of = nullptr;
template <>
inline constexpr const char* name_of<points> = "points";
template <>
inline constexpr const char* name_of<image> = "image";
template <>
inline constexpr const char* name_of<listed_samples> = "source of one's own";
template <>
inline constexpr const char* name_of<balls> = "balls";
template <>
inline constexpr const char* name_of<full_balls> = "full balls";
template <>
inline constexpr const char* name_of<uncertain_image> = "uncertain image";
template <>
inline constexpr const char* name_of<room> = "hidden room";
template <>
inline constexpr const char* name_of<uncertain_room> = "uncertain hidden room";

/// Calls `f.template operator()<S>()` for each kind.
template <class... S, class F>
void for_each_kind(kinds<S...>, const F& f) {
  (f.template operator()<S>(), ...);
}
template <class S, class... All>
constexpr bool is_among(kinds<All...>) {
  return (std::is_same_v<S, All> || ...);
}

namespace detail {
template <class... T>
kinds<T...> joined(kinds<T...>);
template <class... A, class... B, class... More>
auto joined(kinds<A...>, kinds<B...>, More... more) {
  return joined(kinds<A..., B...>(), more...);
}
template <class Q, form F, class On, class... S>
auto taken_of(kinds<S...>) {
  return joined(kinds<>(),
                std::conditional_t<clearance::why_not<Q, placed<S>, F, On>() == nullptr, kinds<S>, kinds<>>()...);
}
template <class... S>
std::vector<std::variant<placed<S>...>> clouds_of(kinds<S...>);
}  // namespace detail

/// Those kinds that Q takes in a form on a backend, and clouds of any kinds.
template <class Q, form F = form::once, class On = clearance::host>
using taken = decltype(detail::taken_of<Q, F, On>(all_kinds()));
template <class Kinds>
using clouds_of = decltype(detail::clouds_of(Kinds()));

namespace detail {
template <class... S, class Others>
auto common_of(kinds<S...>, Others) {
  return joined(kinds<>(), std::conditional_t<is_among<S>(Others()), kinds<S>, kinds<>>()...);
}
}  // namespace detail
/// The kinds that are in both lists.
template <class Some, class Others>
using common = decltype(detail::common_of(Some(), Others()));

/// The kinds that are asked in the test. An uncertain image is like balls, but for a question about images; of full
/// balls tests/questions/solid_balls_test asks everything.
template <class Q, form F = form::once>
using asked_here =
    std::conditional_t<clearance::lists<Q, clearance::of_images>, taken<Q, F>,
                       common<kinds<points, image, listed_samples, balls, room, uncertain_room>, taken<Q, F>>>;

/// What all of them show.
struct scene_before_a_robot {
  scene<inner_sphere> s;
  std::vector<vec3> at;
  std::vector<std::uint16_t> pixels;
  std::vector<clearance::sample> samples;
  Eigen::Isometry3d at_pose = shifted(0.1, -0.05, 0), camera_pose = shifted(0.05, 0, -2);

  explicit scene_before_a_robot(unsigned seed = 5, std::size_t count = 700) {
    dice d(seed);
    for (int part = 0; part < 3; ++part) {
      s.parts.push_back(random_spheres(d, 12, 0.15, 0.05));
      s.poses.push_back(d.pose(0.6));
    }
    at = d.points(count, 1.2);
    at[count / 3].y = clearance::not_a_number;
    for (std::size_t i = 0; i < width * height; ++i)
      pixels.push_back(i % 11 == 0 ? std::uint16_t(0) : std::uint16_t(d.uniform(700, 3200)));
    const image its = seen(true);
    for (std::size_t i = 0; i < its.size(); ++i) samples.push_back(its[i]);
  }

  static constexpr std::uint32_t width = 31, height = 17;

  /// The robot's poses in so many configurations, one after another.
  std::vector<Eigen::Isometry3d> configurations(std::size_t count) const {
    std::vector<Eigen::Isometry3d> all;
    for (std::size_t c = 0; c < count; ++c)
      for (const Eigen::Isometry3d& pose : s.poses) all.push_back(shifted(0.2 * double(c), -0.1 * double(c), 0) * pose);
    return all;
  }

  /// `there`: or a camera without a pixel.
  image seen(bool there) const { return {pixels.data(), there ? width : 0, there ? height : 0, {25, 25, 15, 8}}; }
  points spots(bool there) const { return {at.data(), there ? at.size() : 0}; }
  room behind(bool there) const { return {seen(there), {0.3f, 4}, 0.002f}; }

  /// A source of kind S, or one of that kind without points. `radius`: of what is uncertain, more or less. `off`: more
  /// than a position of any kind is off.
  template <class S>
  placed<S> cloud(bool there, real radius = 0, clearance::position_error off = {}) const {
    const some_radius noise{radius};
    if constexpr (std::is_same_v<S, points>) return {spots(there), at_pose};
    if constexpr (std::is_same_v<S, balls>) return {balls(spots(there), noise), at_pose};
    if constexpr (std::is_same_v<S, image>) return {seen(there), camera_pose};
    if constexpr (std::is_same_v<S, uncertain_image>) return {uncertain_image(seen(there), noise), camera_pose};
    if constexpr (std::is_same_v<S, room>) return {behind(there), camera_pose};
    if constexpr (std::is_same_v<S, uncertain_room>) return {uncertain_room(behind(there), noise), camera_pose};
    if constexpr (std::is_same_v<S, listed_samples>)
      return {
          listed_samples{samples.data(), there ? samples.size() : 0, off.relative > 0 ? off : rounding_of(seen(true))},
          camera_pose};
  }

  /// One cloud of each kind, of which those are there for which `there(number)`. What is certain of all is decided by
  /// the one whose positions are off most; an image without pixels says less than it says with them.
  template <class... S, class There>
  clouds_of<kinds<S...>> all(kinds<S...>, const There& there, real radius = 0) const {
    clouds_of<kinds<S...>> made;
    std::size_t number = 0;
    (made.emplace_back(cloud<S>(there(number++), radius, {0, 0.004})), ...);
    return made;
  }
};

}  // namespace combinations
