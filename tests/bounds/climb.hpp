// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A search for numbers at which a law has the least room: at random, then uphill from the worst of a few.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace bounds {

/// Random numbers (splitmix64), the same everywhere.
class chance {
 public:
  explicit chance(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint32_t below(std::uint32_t n) { return std::uint32_t((bits() >> 32) * n >> 32); }
  /// From -1 to 1.
  float number() { return std::ldexp(float(std::int32_t(bits() >> 32)), -31); }
  float power(int low, int high) { return std::ldexp(1.0f, low + int(below(std::uint32_t(high - low + 1)))); }

 private:
  std::uint64_t state_;
};

/// What a search of a law has found. Room is what is left before the law breaks, in units of rounding (2^-24) of the
/// lengths that its margin is a share of. Below 0 it is broken.
template <std::size_t N>
struct found {
  std::uint64_t cases = 0, broken = 0;
  double least = std::numeric_limits<double>::infinity();
  std::array<float, N> at = {};
  int law = 0;  ///< Which of the laws that were tried there has the least room.

  void add(const found& other) {
    cases += other.cases, broken += other.broken;
    if (other.least < least) least = other.least, at = other.at, law = other.law;
  }
};

/// The room at one place; infinite where the law says nothing.
struct room {
  double left = std::numeric_limits<double>::infinity();
  int law = 0;

  void add(double its, int number) {
    if (its < left) left = its, law = number;
  }
  void require(bool holds, int number) {
    if (!holds) add(-1e9, number);
  }
};

/// Makes a few numbers from `first` on a little different, or equal to another one, or 0.
template <std::size_t N>
void change(std::array<float, N>& x, std::size_t first, chance& c) {
  for (std::uint32_t times = 1 + c.below(3); times != 0; --times) {
    float& it = x[first + c.below(std::uint32_t(N - first))];
    const float other = x[c.below(N)];
    switch (c.below(8)) {
      case 0:
        it = std::nextafter(it, c.below(2) != 0 ? 1e30f : -1e30f);
        break;
      case 1:
        it = c.below(4) != 0 ? other : c.below(2) != 0 ? -it : 0;
        break;
      case 2:
        it += other * (c.number() * c.power(-24, 0));
        break;
      default:
        it += it * (c.number() * c.power(-24, 0));
    }
  }
}

/// Tries a law at about `cases` places. `Law::numbers` says how many numbers it has, `law.draw(numbers, from, chance)`
/// draws those from 0 or from `Law::content` on, which cost little to change, and `law(numbers)` says which room is
/// left.
template <class Law>
found<Law::numbers> search(const Law& law, std::uint64_t cases, std::uint64_t seed) {
  constexpr int drawn = 32, steps = 224;
  chance c(seed);
  found<Law::numbers> all;
  const auto look = [&](const std::array<float, Law::numbers>& x) {
    const room r = law(x);
    ++all.cases, all.broken += r.left < 0;
    if (r.left < all.least) all.least = r.left, all.at = x, all.law = r.law;
    return r.left;
  };
  while (all.cases < cases) {
    std::array<float, Law::numbers> best{}, x{};
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < drawn; ++k) {
      law.draw(x, k % 8 == 0 ? 0 : Law::content, c);
      if (const double its = look(x); its <= least) least = its, best = x;
    }
    for (int k = 0; k < steps; ++k) {
      x = best;
      change(x, c.below(8) == 0 ? 0 : Law::content, c);
      if (!std::all_of(x.begin(), x.end(), [](float v) { return std::abs(v) < 1e9f; })) continue;
      if (const double its = look(x); its <= least) least = its, best = x;
    }
  }
  return all;
}

}  // namespace bounds
