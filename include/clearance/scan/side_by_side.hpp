// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>

#include <array>
#include <type_traits>
#include <utility>

namespace clearance::scan {

/// Values whose words lie side by side, so that a loop over them becomes vector code on a host.
template <class T, std::size_t Lanes = 8>
struct side_by_side {
  static constexpr std::size_t words = sizeof(T) / sizeof(real);
  using one = std::array<real, words>;
  alignas(64) real word[words][Lanes];

  void put(std::size_t j, const T& value) {
    const one its = std::bit_cast<one>(value);
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
template <class T, std::size_t Lanes>
  requires(!std::is_trivially_copyable_v<T> || sizeof(T) % sizeof(real) != 0)
struct side_by_side<T, Lanes> {
  const T* its[Lanes];

  void put(std::size_t j, const T& value) { its[j] = &value; }
  const T& operator[](std::size_t j) const { return *its[j]; }
};

}  // namespace clearance::scan
