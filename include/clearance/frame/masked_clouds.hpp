// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds of any kind behind a mask.

#include <clearance/frame/mapped_clouds.hpp>
#include <clearance/points/masked.hpp>

namespace clearance {

namespace detail {

struct behind_labels {
  const point_label* labels;

  template <point_source S>
  masked<S> operator()(const S& source) {
    const point_label* const its = labels;
    labels += source.size();
    return {source, its};
  }
};

}  // namespace detail

/// The same clouds (any that a call takes) without the points labelled `own`. `labels` has one label per point of all
/// clouds, in order, in memory that the query's backend can read. Views: clouds and labels must outlive them.
template <class Clouds>
auto masked_clouds(const Clouds& clouds, const point_label* labels) {
  return mapped_clouds(clouds, detail::behind_labels{labels});
}

}  // namespace clearance
