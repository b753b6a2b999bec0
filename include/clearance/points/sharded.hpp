// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud made of pieces, the reverse of slices.

#include <clearance/concepts/capsule.hpp>
#include <clearance/points/slice.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace clearance {

/// Up to 16 sources of one kind, one after another. Points are numbered through all of them. Each piece may be in the
/// memory of another device, and may be empty. Pieces may be `uncertain`, and so may the whole.
template <point_source S>
class sharded {
  static_assert(points_or_balls<S>());

 public:
  using can = can_all<
      clearance::can<sources::rounded, sources::ranged, sources::seen, sources::in_pieces, sources::copied_in_pieces>,
      can_if<ball_source<S>, sources::capsules>, can_as<S, sources::shared>>;
  static constexpr std::size_t most = 16;  // as an argument of a kernel it has 4 KiB
  static constexpr bool vague = vague_source<S>, balls = ball_source<S>, only_on_device = detail::only_on_device<S>();

  /// Throws std::invalid_argument if there are no pieces or too many.
  explicit sharded(const std::vector<S>& pieces) : sharded(checked(pieces), std::make_index_sequence<most>()) {}

  CLEARANCE_HD std::size_t size() const { return first_[most]; }

  /// f(piece, j) of the piece that has point i as its j-th.
  template <class F>
  CLEARANCE_HD auto with_piece_of(std::size_t i, const F& f) const {
    std::uint32_t k = 0;
    while (i >= first_[k + 1]) ++k;
    return f(piece_[k], i - first_[k]);
  }

  CLEARANCE_HD sample operator[](std::size_t i) const {
    return with_piece_of(i, [](const S& piece, std::size_t j) { return piece[j]; });
  }
  CLEARANCE_HD capsule around(std::size_t i, vec3 p) const
    requires ball_source<S>
  {
    return with_piece_of(i, [p](const S& piece, std::size_t j) { return piece.around(j, p); });
  }
  CLEARANCE_HD radius_shares shares(std::size_t i, vec3 p) const
    requires shared_source<S>
  {
    return with_piece_of(i, [p](const S& piece, std::size_t j) { return piece.shares(j, p); });
  }
  CLEARANCE_HD real beyond(std::size_t i, vec3 p) const {
    return with_piece_of(i, [p](const S& piece, std::size_t j) { return beyond_range(piece, j, p); });
  }
  CLEARANCE_HD vec3 sensor() const { return sensor_of(piece_[0]); }
  /// The largest errors of all pieces.
  position_error rounding() const {
    position_error worst;
    for (const S& piece : piece_) {
      const position_error error = rounding_of(piece);
      worst = {std::max(worst.absolute, error.absolute), std::max(worst.relative, error.relative),
               std::max(worst.gap, error.gap)};
    }
    return worst;
  }

  /// This cloud with `f(piece)`, of the same type, in the place of each piece.
  template <class F>
  sharded with_pieces(const F& f) const {
    sharded same = *this;
    for (std::size_t k = 0; k < most; ++k) same.piece_[k] = k < pieces_ ? f(piece_[k]) : same.piece_[pieces_ - 1];
    return same;
  }

  std::size_t pieces() const { return pieces_; }
  CLEARANCE_HD const S& piece(std::size_t k) const { return piece_[k]; }
  /// The number of piece k's first point. For k = pieces(), the number of points.
  std::size_t first(std::size_t k) const { return first_[k]; }

 private:
  template <std::size_t... K>
  sharded(const std::vector<S>& pieces, std::index_sequence<K...>)
      : piece_{pieces[std::min(K, pieces.size() - 1)]...}, pieces_(pieces.size()) {
    for (std::size_t k = 0; k < most; ++k) first_[k + 1] = first_[k] + (k < pieces_ ? piece_[k].size() : 0);
  }
  static const std::vector<S>& checked(const std::vector<S>& pieces) {
    if (pieces.empty()) throw std::invalid_argument("clearance: a cloud of no pieces; an empty piece is one");
    if (pieces.size() > most)
      throw std::invalid_argument("clearance: a cloud of " + std::to_string(pieces.size()) + " pieces, more than " +
                                  std::to_string(most));
    return pieces;
  }

  S piece_[most];
  std::size_t pieces_;
  std::size_t first_[most + 1] = {};
};

/// The number of the first point of piece `k`, if a cloud is split into `n`: sharded clouds into their own pieces,
/// others into about equal slices. For k = n, the number of points.
template <point_source S>
std::size_t first_of_piece(const S& cloud, std::size_t k, std::size_t n) {
  if constexpr (sharded_source<S>)
    return cloud.first(k);
  else
    return first_of_slice(cloud.size(), k, n);
}
template <point_source S>
auto piece_of(const S& cloud, std::size_t k, std::size_t n) {
  if constexpr (sharded_source<S>)
    return cloud.piece(k);
  else
    return slice(cloud, first_of_piece(cloud, k, n), first_of_piece(cloud, k + 1, n));
}

/// Throws std::invalid_argument if a sharded cloud does not have `n` pieces.
template <point_source S>
void check_pieces(const S& cloud, std::size_t n) {
  if constexpr (sharded_source<S>)
    if (cloud.pieces() != n)
      throw std::invalid_argument("clearance: a cloud of " + std::to_string(cloud.pieces()) + " pieces for " +
                                  std::to_string(n) + " devices");
}

}  // namespace clearance
