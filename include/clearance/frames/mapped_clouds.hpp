// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Maps clouds of any kind, each to another.

#include <clearance/frames/clouds.hpp>
#include <clearance/ground/borrowed.hpp>
#include <clearance/points/masked.hpp>

namespace clearance {

namespace detail {

/// What `f` makes of a source, or of a source and its pose.
template <class F, point_source S>
auto made_of(F& f, const S& source, const Eigen::Isometry3d& world_from_cloud) {
  if constexpr (std::invocable<F&, const S&, const Eigen::Isometry3d&>)
    return f(source, world_from_cloud);
  else
    return f(source);
}
template <class F, point_source S>
using made_type = decltype(made_of(std::declval<F&>(), std::declval<const S&>(), Eigen::Isometry3d()));

/// The type that clouds become, and how. This is for ranges:
template <class T, class F>
struct mapped {
  using one = mapped<std::remove_cvref_t<decltype(*std::begin(std::declval<const T&>()))>, F>;
  using type = std::vector<typename one::type>;
  static type of(const T& clouds, F& f) {
    type sources;
    for (const auto& cloud : clouds) sources.push_back(one::of(cloud, f));
    return sources;
  }
};
template <point_source S, class F>
struct mapped<S, F> {
  using type = made_type<F, S>;
  static type of(const S& source, F& f) { return made_of(f, source, Eigen::Isometry3d::Identity()); }
};
template <point_container C, class F>
struct mapped<C, F> {
  using one = mapped<points_in<C>, F>;
  using type = typename one::type;
  static type of(const C& points, F& f) { return one::of(points_of(points), f); }
};
template <point_source S, class F>
struct mapped<placed<S>, F> {
  using type = placed<typename mapped<S, F>::type>;
  static type of(const placed<S>& cloud, F& f) { return {made_of(f, cloud.source, cloud.pose), cloud.pose}; }
};
template <class... T, class F>
struct mapped<std::tuple<T...>, F> {
  using type = std::tuple<typename mapped<T, F>::type...>;
  static type of(const std::tuple<T...>& clouds, F& f) {
    return std::apply([&](const T&... each) { return type{mapped<T, F>::of(each, f)...}; },
                      clouds);  // braces: from left to right
  }
};
template <class... T, class F>
struct mapped<std::variant<T...>, F> {
  using type = std::variant<typename mapped<T, F>::type...>;
  static type of(const std::variant<T...>& one, F& f) { return at<0>(one, f); }

 private:
  /// By index, because several alternatives may become the same type.
  template <std::size_t I>
  static type at(const std::variant<T...>& one, F& f) {
    if constexpr (I + 1 < sizeof...(T))
      if (one.index() != I) return at<I + 1>(one, f);
    return type(std::in_place_index<I>,
                mapped<std::variant_alternative_t<I, std::variant<T...>>, F>::of(std::get<I>(one), f));
  }
};

}  // namespace detail

namespace detail {

/// Do clouds keep points themselves, as a vector of points does, and not views of them?
template <class T>
inline constexpr bool keeps_points = owning_points<T>;
template <class... T>
inline constexpr bool keeps_points<std::tuple<T...>> = (keeps_points<T> || ...);
template <class... T>
inline constexpr bool keeps_points<std::variant<T...>> = (keeps_points<T> || ...);
template <class T>
  requires(!point_source<T> && !point_container<T>) && owning_range<T>
inline constexpr bool keeps_points<T> = keeps_points<std::ranges::range_value_t<T>>;
template <class T>
concept owning_clouds = keeps_points<T>;

}  // namespace detail

/// Clouds (any that a call takes) with `f(source)`, or `f(source, world_from_cloud)`, in the place of each source, in
/// order. They are views: what they view must outlive them. `F` must not be a lambda, because its name becomes part of
/// a kernel's.
template <class Clouds, class F>
auto mapped_clouds(const Clouds& clouds, F f) {
  static_assert(explain_clouds<Clouds>());
  return detail::mapped<Clouds, F>::of(clouds, f);
}

// Clouds of any kind behind a mask.

namespace detail {

struct behind_labels {
  const point_label* labels;

  template <point_source S>
  masked<S> operator()(const S& source) {
    const point_label* const first = labels;
    labels += source.size();
    return {source, first};
  }
};

}  // namespace detail

/// Clouds (any that a call takes) without the points labelled `own`. `labels` has one label per point of all
/// clouds, in order, in memory that the query's backend can read. Views: clouds and labels must outlive them.
template <class Clouds>
auto masked_clouds(const Clouds& clouds, const point_label* labels) {
  return mapped_clouds(clouds, detail::behind_labels{labels});
}
template <detail::owning_clouds Clouds>
void masked_clouds(const Clouds&&, const point_label*) = delete;  // the points would be gone; give them a name

}  // namespace clearance
