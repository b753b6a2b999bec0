// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which parts of a robot can meet: the pairs that a question about the robot itself looks at.

#include <clearance/result.hpp>

#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace clearance {

/// Pairs of a robot's parts, without an order. At first all are there; those that always touch, as neighbours do, or
/// never can, are removed once (MoveIt's `disable_collisions`). Throws std::invalid_argument for parts that are not
/// there, and for a pair of a part with itself.
class part_pairs {
 public:
  explicit part_pairs(std::size_t parts) : parts_(parts), has_(parts * parts, true) {
    for (std::size_t k = 0; k < parts; ++k) has_[k * parts + k] = false;
  }

  std::size_t parts() const { return parts_; }
  bool has(std::size_t a, std::size_t b) const { return has_[checked(a, b)]; }
  part_pairs& set(std::size_t a, std::size_t b, bool has) {
    has_[checked(a, b)] = has;
    has_[checked(b, a)] = has;
    return *this;
  }
  part_pairs& remove(std::size_t a, std::size_t b) { return set(a, b, false); }
  part_pairs& remove(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
    for (const auto& [a, b] : pairs) remove(a, b);
    return *this;
  }
  /// Removes each part's pair with its parent: `parents` has one for each part, or `none`.
  part_pairs& remove_neighbours(std::span<const std::uint32_t> parents) {
    if (parents.size() != parts_)
      throw std::invalid_argument("clearance: there are " + std::to_string(parts_) + " parts, but " +
                                  std::to_string(parents.size()) + " parents");
    for (std::size_t k = 0; k < parts_; ++k)
      if (parents[k] != none) remove(k, parents[k]);
    return *this;
  }

  /// The parts above `a` that it can meet, ascending. So each pair is named once, the lower part first.
  std::vector<std::uint32_t> above(std::size_t a) const {
    std::vector<std::uint32_t> all;
    for (std::size_t b = a + 1; b < parts_; ++b)
      if (has_[a * parts_ + b]) all.push_back(std::uint32_t(b));
    return all;
  }
  /// How many pairs there are.
  std::size_t size() const {
    std::size_t n = 0;
    for (std::size_t a = 0; a < parts_; ++a) n += above(a).size();
    return n;
  }

 private:
  std::size_t checked(std::size_t a, std::size_t b) const {
    if (a >= parts_ || b >= parts_ || a == b)
      throw std::invalid_argument("clearance: parts " + std::to_string(a) + " and " + std::to_string(b) +
                                  " are no pair of a robot of " + std::to_string(parts_) + " parts");
    return a * parts_ + b;
  }

  std::size_t parts_;
  std::vector<bool> has_;
};

}  // namespace clearance
