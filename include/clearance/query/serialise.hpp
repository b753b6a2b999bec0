// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A result as bytes, for other processes.

#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <vector>

namespace clearance::detail {

struct any_value {
  template <class T>
  operator T() const;
};

/// How many members an aggregate has, up to 8.
template <class T, class... Values>
consteval std::size_t count_members() {
  if constexpr (sizeof...(Values) < 8 && requires { T{Values{}..., any_value{}}; })
    return count_members<T, Values..., any_value>();
  else
    return sizeof...(Values);
}

/// Its members, as a tuple of references.
template <class T>
auto members_of(T& r) {
  constexpr std::size_t n = count_members<std::remove_const_t<T>>();
  static_assert(n >= 1 && n <= 8, "a result that goes to other processes is an aggregate of one to eight members");
  if constexpr (n == 1) {
    auto& [a] = r;
    return std::tie(a);
  } else if constexpr (n == 2) {
    auto& [a, b] = r;
    return std::tie(a, b);
  } else if constexpr (n == 3) {
    auto& [a, b, c] = r;
    return std::tie(a, b, c);
  } else if constexpr (n == 4) {
    auto& [a, b, c, d] = r;
    return std::tie(a, b, c, d);
  } else if constexpr (n == 5) {
    auto& [a, b, c, d, e] = r;
    return std::tie(a, b, c, d, e);
  } else if constexpr (n == 6) {
    auto& [a, b, c, d, e, f] = r;
    return std::tie(a, b, c, d, e, f);
  } else if constexpr (n == 7) {
    auto& [a, b, c, d, e, f, g] = r;
    return std::tie(a, b, c, d, e, f, g);
  } else {
    auto& [a, b, c, d, e, f, g, h] = r;
    return std::tie(a, b, c, d, e, f, g, h);
  }
}

/// Appends plain values, vectors of them, and aggregates of those.
template <class T>
void pack(std::vector<std::byte>& bytes, const T& value) {
  const auto append = [&](const void* from, std::size_t size) {
    const auto* const its = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), its, its + size);
  };
  if constexpr (std::is_trivially_copyable_v<T>) {
    append(&value, sizeof value);
  } else if constexpr (requires(T t) { t.data(), t.resize(0); }) {
    static_assert(std::is_trivially_copyable_v<typename T::value_type>);
    const std::size_t size = value.size();
    append(&size, sizeof size);
    append(value.data(), size * sizeof(typename T::value_type));
  } else {
    std::apply([&](const auto&... each) { (pack(bytes, each), ...); }, members_of(value));
  }
}

/// The reverse; takes the bytes off `from`. Throws std::runtime_error if there are too few.
template <class T>
void unpack(std::span<const std::byte>& from, T& value) {
  const auto take = [&](void* to, std::size_t size) {
    if (size > from.size()) throw std::runtime_error("clearance: another process sent too few bytes");
    if (size != 0) std::memcpy(to, from.data(), size);
    from = from.subspan(size);
  };
  if constexpr (std::is_trivially_copyable_v<T>) {
    take(&value, sizeof value);
  } else if constexpr (requires(T t) { t.data(), t.resize(0); }) {
    std::size_t size = 0;
    take(&size, sizeof size);
    if (size > from.size() / sizeof(typename T::value_type))
      throw std::runtime_error("clearance: another process sent too few bytes");
    value.resize(size);
    take(value.data(), size * sizeof(typename T::value_type));
  } else {
    std::apply([&](auto&... each) { (unpack(from, each), ...); }, members_of(value));
  }
}

}  // namespace clearance::detail
