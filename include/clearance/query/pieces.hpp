// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Joins answers about pieces of all clouds: of several devices, chunks, ranks, or up to a deadline.

#include <clearance/concepts.hpp>
#include <clearance/frames/mapped_clouds.hpp>
#include <clearance/points/sharded.hpp>

#include <optional>
#include <vector>

namespace clearance::detail {

/// Joins results by the question's `merge`.
template <class Q>
class joined_by_merge {
 public:
  joined_by_merge(const Q&, std::span<const part_facts>) {}

  void add(typename Q::result piece, const piece_place& place) {
    if constexpr (numbering_question<Q>) Q::place_in_whole(piece, place);
    if (all_)
      Q::merge(*all_, piece);
    else
      all_ = std::move(piece);
  }
  typename Q::result result() { return std::move(*all_); }

 private:
  std::optional<typename Q::result> all_;
};

template <class Q, class PartView>
struct joined_for {
  static_assert(merging_question<Q>);  // the user's door says why not (query/combination.hpp)
  using type = joined_by_merge<Q>;
};
template <class Q, class PartView>
  requires joining_question<Q>
struct joined_for<Q, PartView> {
  using type = typename Q::template joined<PartView>;
};
template <class Q, class PartView>
using joined_of = typename joined_for<Q, PartView>::type;

/// The k-th of n pieces of any source.
struct one_piece {
  std::size_t k, n;

  template <point_source S>
  auto operator()(const S& source) const {
    return piece_of(source, k, n);
  }
};

/// Slices `begin` to `end - 1` of `n` of any source.
struct some_slices {
  std::size_t begin, end, n;

  template <point_source S>
  auto operator()(const S& source) const {
    return slice(source, first_of_slice(source.size(), begin, n), first_of_slice(source.size(), end, n));
  }
};

/// Where pieces lie in all clouds of a call. It is kept, so that it allocates only for more clouds than ever before.
class piece_numbers {
 public:
  /// Throws std::invalid_argument if there are too many points.
  template <class Clouds>
  void count(const Clouds& clouds) {
    whole_.clear();
    total_ = 0;
    for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) {
      whole_.push_back(std::uint32_t(source.size()));
      total_ += source.size();
    });
    if (total_ >= ~std::uint32_t(0)) throw std::invalid_argument("clearance: more than 2^32 - 2 points in one call");
  }
  std::uint64_t total() const { return total_; }
  std::size_t clouds() const { return whole_.size(); }

  /// The piece of each cloud from `begin(cloud)` to `end(cloud)`; valid until the next call.
  template <class Clouds, class Begin, class End>
  piece_place place(const Clouds& clouds, const Begin& begin, const End& end) {
    first_.clear();
    count_.clear();
    for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) {
      first_.push_back(std::uint32_t(begin(source)));
      count_.push_back(std::uint32_t(end(source)) - first_.back());
    });
    return {first_, count_, whole_};
  }
  template <class Clouds>
  piece_place place(const Clouds& clouds, const one_piece& p) {
    return place(
        clouds, [&](const auto& source) { return first_of_piece(source, p.k, p.n); },
        [&](const auto& source) { return first_of_piece(source, p.k + 1, p.n); });
  }
  template <class Clouds>
  piece_place place(const Clouds& clouds, const some_slices& s) {
    return place(
        clouds, [&](const auto& source) { return first_of_slice(source.size(), s.begin, s.n); },
        [&](const auto& source) { return first_of_slice(source.size(), s.end, s.n); });
  }

 private:
  std::vector<std::uint32_t> whole_, first_, count_;
  std::uint64_t total_ = 0;
};

}  // namespace clearance::detail
