// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>

#include <array>
#include <cstring>
#include <type_traits>
#include <utility>

namespace clearance::scan {

/// Eight values whose words lie side by side, so that a loop over them becomes vector code on a host.
template <class T>
struct eight {
  static constexpr std::size_t words = sizeof(T) / sizeof(real);
  using one = std::array<real, words>;
  alignas(32) real word[words][8];

  void put(std::size_t j, const T& value) {
    one its;
    std::memcpy(its.data(), &value, sizeof value);
    for (std::size_t w = 0; w < words; ++w) word[w][j] = its[w];
  }
  T operator[](std::size_t j) const { return at(j, std::make_index_sequence<words>{}); }

 private:
  template <std::size_t... W>
  T at(std::size_t j, std::index_sequence<W...>) const {
    return std::bit_cast<T>(one{word[W][j]...});
  }
};

/// The same for what is not made of words.
template <class T>
  requires(!std::is_trivially_copyable_v<T> || sizeof(T) % sizeof(real) != 0)
struct eight<T> {
  const T* its[8];

  void put(std::size_t j, const T& value) { its[j] = &value; }
  const T& operator[](std::size_t j) const { return *its[j]; }
};

}  // namespace clearance::scan
