// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Views that cannot be made of what is gone after the statement.

#include <clearance/ground/config.hpp>

#include <cstddef>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace clearance {

/// A range that owns its elements: a view of a temporary one would look at freed memory. Spans of any library name the
/// type that they view.
template <class R>
concept owning_range =
    std::ranges::contiguous_range<R> && !std::ranges::borrowed_range<R> && !requires { typename R::element_type; };

/// A std::span<const T> that is not made of a temporary vector or array.
template <class T>
struct borrowed : std::span<const T> {
  constexpr borrowed() = default;
  constexpr borrowed(const T* data, std::size_t size) : std::span<const T>(data, size) {}
  constexpr borrowed(std::span<const T> all) : std::span<const T>(all) {}
  template <std::ranges::contiguous_range R>
    requires std::ranges::sized_range<R> && std::is_convertible_v<const R&, std::span<const T>> &&
             (!std::is_base_of_v<borrowed, R>)
  constexpr borrowed(const R& all CLEARANCE_LIFETIMEBOUND) : std::span<const T>(all) {}
  template <owning_range R>
  constexpr borrowed(const R&&) = delete;  // it would be gone before it is read; give it a name
};

/// A std::string_view that is not made of a temporary string.
struct borrowed_text : std::string_view {
  constexpr borrowed_text() = default;
  constexpr borrowed_text(const char* text) : std::string_view(text) {}
  constexpr borrowed_text(std::string_view text) : std::string_view(text) {}
  constexpr borrowed_text(const std::string& text CLEARANCE_LIFETIMEBOUND) : std::string_view(text) {}
  constexpr borrowed_text(const std::string&&) = delete;  // it would be gone before it is read; give it a name
};

}  // namespace clearance

template <class T>
inline constexpr bool std::ranges::enable_borrowed_range<clearance::borrowed<T>> = true;
template <class T>
inline constexpr bool std::ranges::enable_view<clearance::borrowed<T>> = true;
