// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where work runs.

#include <clearance/ground/indices.hpp>

#include <concepts>
#include <cstddef>
#include <exception>
#include <new>
#include <span>
#include <vector>

namespace clearance {

/// Where work runs and where its memory lives: a value, and the first argument of every operation.
///
/// Law: work given to one backend value runs in the order given; `wait()` returns when all of it is done.
/// Law: `for_ranges` calls `body(indices)` for ranges that together cover 0 .. n-1 once, `for_each` body(i) for each.
/// Law: `stage` has taken its input when it returns, and does not wait. Scratch memory lives until all work given
/// before its end is done. `reads` says whether bodies can read an address as it is.
template <class B>
concept backend = requires(const B on, std::size_t n, void (*one)(std::size_t), void (*range)(indices),
                           typename B::template buffer<int> data, std::span<const int> input, int* there) {
  on.for_each(n, one);
  on.for_ranges(n, range);
  on.wait();
  { on.copy_in(input) } -> std::same_as<typename B::template buffer<int>>;
  { on.copy_out(data) } -> std::same_as<std::vector<int>>;
  { on.copy_out(there, n) } -> std::same_as<std::vector<int>>;
  { on.template make_scratch<int>(n) } -> std::same_as<typename B::template scratch<int>>;
  on.stage(input, there);
  { on.reads(there) } -> std::same_as<bool>;
};

namespace detail {

/// Did memory end, on the host or where `on` runs?
template <backend B>
bool out_of_memory(const B& on, const std::exception& error) {
  if constexpr (requires { on.out_of_memory(error); })
    if (on.out_of_memory(error)) return true;
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
}

}  // namespace detail

}  // namespace clearance
