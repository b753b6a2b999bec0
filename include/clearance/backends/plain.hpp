// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Any backend with a traversal of your choice, for those who compare traversals.

#include <clearance/concepts.hpp>

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

namespace detail {

/// The backend itself.
template <class On>
const On& backend_of(const On& on) {
  return on;
}
template <class B, class Traversal>
const B& backend_of(const plain<B, Traversal>& on) {
  return on.on;
}
template <class On>
using backend_of_t = std::remove_cvref_t<decltype(backend_of(std::declval<const On&>()))>;

}  // namespace detail

}  // namespace clearance
