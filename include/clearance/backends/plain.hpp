// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Any backend with a traversal of your choice: the library's or your own.

#include <clearance/backends/kept_memory.hpp>
#include <clearance/backends/one_call.hpp>
#include <clearance/backends/readback.hpp>
#include <clearance/concepts.hpp>

namespace clearance {

/// A backend on which each point walks trees by a traversal of your choice, as in the paper. Pass it in place of the
/// backend, with any question: the answer has the same bits. It has no scan of its own, so it is slower.
template <class B, class Traversal>
struct plain : B {
  Traversal walk = {};
};
template <class B, class Traversal>
plain(B, Traversal) -> plain<B, Traversal>;

namespace detail {

template <class On>
inline constexpr bool is_plain = false;
template <class B, class Traversal>
inline constexpr bool is_plain<plain<B, Traversal>> = true;

template <class B, class Traversal>
struct one_call<plain<B, Traversal>> : one_call<B> {};

}  // namespace detail

namespace backends {

template <class B, class Traversal>
class memory_of<plain<B, Traversal>> : public memory_of<B> {
 public:
  using memory_of<B>::memory_of;
};

template <class B, class Traversal>
class readback<plain<B, Traversal>> : public readback<B> {
 public:
  using readback<B>::readback;
};

}  // namespace backends

}  // namespace clearance
