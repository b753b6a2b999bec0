// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which search finds a least distance, by where it runs.

#include <clearance/answer/host_search.hpp>

namespace clearance {

/// A backend with a traversal of your choice: the loop over points, as in the paper, for those who study traversals.
/// Pass it in place of a backend.
template <backend B, class Traversal>
struct plain {
  B on;
  Traversal walk = {};
};
template <backend B, class Traversal>
plain(B, Traversal) -> plain<B, Traversal>;

namespace minimum {

/// Takes every source as it is.
struct as_it_is {
  template <point_source S>
  const S& operator()(const S& source, std::uint32_t) const {
    return source;
  }
};

/// Copies of clouds that a backend cannot read where they are, with the clouds' numbers.
template <backend B>
using cloud_copies = std::vector<std::pair<std::uint32_t, typename B::template buffer<std::byte>>>;

/// The source itself if the backend can read its memory, else a source over a copy that `copies` keeps.
template <backend B>
struct readable_on {
  const B& on;
  cloud_copies<B>& copies;

  template <point_source S>
  S operator()(const S& source, std::uint32_t cloud) const {
    if constexpr (requires { source.at(source.bytes().data()); }) {
      if (source.size() != 0 && !on.reads(source.bytes().data())) {
        auto copy = std::find_if(copies.begin(), copies.end(), [cloud](const auto& c) { return c.first == cloud; });
        if (copy == copies.end()) copy = copies.insert(copy, {cloud, on.copy_in(source.bytes())});
        return source.at(copy->second.data());
      }
    }
    return source;
  }
};

/// A backend of your own uses the plain loop.
template <class On>
struct search_on {
  static_assert(
      !requires { typename On::own_scan; },
      "a device has a scan of its own: include <clearance/min_distance.cuh>, not the .hpp");

  static const On& backend_of(const On& on) { return on; }
  /// Enqueues one frame; with `PerPart` also every part's minimum.
  template <bool PerPart, class PartView, class Clouds, class Here>
  static void once(const On& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                   const Clouds& clouds, min_distance_result* result, part_minimum* minima, const Here& here) {
    plain_search<On, PartView, near_first>(on, model, {})(poses, clouds, result, minima, here);
  }
};

template <class B, class Traversal>
struct search_on<plain<B, Traversal>> {
  static const B& backend_of(const plain<B, Traversal>& on) { return on.on; }
  template <bool PerPart, class PartView, class Clouds, class Here>
  static void once(const plain<B, Traversal>& on, const model_view<PartView>& model,
                   std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result,
                   part_minimum* minima, const Here& here) {
    static_assert(traversal<Traversal, typename PartView::hierarchy_type, shared_nearest>,
                  "this is no traversal of the parts' trees");
    plain_search<B, PartView, Traversal>(on.on, model, on.walk)(poses, clouds, result, minima, here);
  }
};

template <>
struct search_on<host> {
  static const host& backend_of(const host& on) { return on; }
  template <bool PerPart, class PartView, class Clouds, class Here>
  static void once(const host& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                   const Clouds& clouds, min_distance_result* result, part_minimum* minima, const Here&) {
    host_search<PartView>(on, model)(poses, clouds, result, minima);
  }
};

}  // namespace minimum

}  // namespace clearance
