// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Answers with an entry for every point, from those about pieces of all clouds.

#include <clearance/concepts.hpp>

#include <algorithm>
#include <numeric>

namespace clearance::pointwise {

/// Puts a piece's entries for its points into those of the whole clouds, `rows` times: once for each part, or once.
template <class Vector>
void place_entries(const Vector& piece, const piece_place& place, Vector& whole, std::size_t rows = 1) {
  const auto sum = [](auto of) { return std::accumulate(of.begin(), of.end(), std::size_t(0)); };
  const std::size_t all = sum(place.whole), some = sum(place.count);
  whole.resize(all * rows);
  if (piece.empty()) return;
  for (std::size_t row = 0; row < rows; ++row) {
    auto from = piece.begin() + std::ptrdiff_t(row * some);
    auto to = whole.begin() + std::ptrdiff_t(row * all);
    for (std::size_t c = 0; c < place.first.size(); ++c) {
      std::copy_n(from, place.count[c], to + std::ptrdiff_t(place.first[c]));
      from += std::ptrdiff_t(place.count[c]);
      to += std::ptrdiff_t(place.whole[c]);
    }
  }
}

template <class Q>
class joined_points {
 public:
  template <class Facts>
  joined_points(const Q&, const Facts&) {}

  void add(const typename Q::result& piece, const piece_place& place) {
    place_entries(piece.distance, place, all_.distance);
    if (!piece.part.empty()) {
      place_entries(piece.part, place, all_.part);
      place_entries(piece.primitive, place, all_.primitive);
    }
    all_.counts.add(piece.counts);
    all_.certain.widen(piece.certain);
  }
  typename Q::result result() { return std::move(all_); }

 private:
  typename Q::result all_;
};

}  // namespace clearance::pointwise
