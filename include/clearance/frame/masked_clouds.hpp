// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds of any kind behind a mask.

#include <clearance/frame/clouds.hpp>
#include <clearance/points/masked.hpp>

namespace clearance {

namespace detail {

/// What kind of clouds they become, and how: `of` moves `labels` on by as many points as there are. Of ranges:
template <class T>
struct behind {
  using one = behind<std::remove_cvref_t<decltype(*std::begin(std::declval<const T&>()))>>;
  using type = std::vector<typename one::type>;
  static type of(const T& clouds, const point_label*& labels) {
    type hidden;
    for (const auto& cloud : clouds) hidden.push_back(one::of(cloud, labels));
    return hidden;
  }
};
template <point_source S>
struct behind<S> {
  using type = masked<S>;
  static type of(const S& source, const point_label*& labels) {
    const point_label* const its = labels;
    labels += source.size();
    return type(source, its);
  }
};
template <class T>
  requires(!point_source<T> && std::is_convertible_v<const T&, point_span>)
struct behind<T> : behind<point_span> {};
template <point_source S>
struct behind<placed<S>> {
  using type = placed<masked<S>>;
  static type of(const placed<S>& cloud, const point_label*& labels) { return {behind<S>::of(cloud.source, labels), cloud.pose}; }
};
template <class... T>
struct behind<std::tuple<T...>> {
  using type = std::tuple<typename behind<T>::type...>;
  static type of(const std::tuple<T...>& clouds, const point_label*& labels) {
    return std::apply([&](const T&... each) { return type{behind<T>::of(each, labels)...}; }, clouds);  // braces: from left to right
  }
};
template <class... T>
struct behind<std::variant<T...>> {
  using type = std::variant<typename behind<T>::type...>;
  static type of(const std::variant<T...>& one, const point_label*& labels) {
    return std::visit([&]<class U>(const U& it) -> type { return behind<U>::of(it, labels); }, one);
  }
};

}  // namespace detail

/// The same clouds (any that a call takes) without the points that are labelled `own`: `labels`, one a point of all clouds in their
/// order, in memory that the query's backend can read. Views: clouds and labels must outlive them.
template <class Clouds>
auto masked_clouds(const Clouds& clouds, const point_label* labels) {
  static_assert(explain_clouds<Clouds>());
  return detail::behind<Clouds>::of(clouds, labels);
}

}  // namespace clearance
