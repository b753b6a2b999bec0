// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance from a cloud that is read in chunks. Its first answer is a bound for what is read afterwards.

#include <clearance/minimum/chunked.hpp>
#include <clearance/minimum/host_search.hpp>

#include <future>

namespace clearance::minimum {

/// Asks about ranges of a chunked cloud on a backend: `(cloud, ranges, poses, pose, result, minima, seen)`. Points are
/// numbered as in the cloud. `minima` has one per part, or is empty. If `seen` is not null, it gets what was seen of
/// each piece.
template <class On, class PartView>
class chunked_search {
  static_assert(!sizeof(On), "a host or a device reads a least distance in chunks, no other backend");
};

/// On the CPU: one chunk is searched while the next is loaded. Ranges of a cloud in one place are searched as one, all
/// at once or a chunk of points at a time, because each search costs the host tens of microseconds to begin.
template <class PartView>
class chunked_search<host, PartView> {
 public:
  chunked_search(const host& on, const model_view<PartView>& model) : search_(on, model) {}

  std::size_t parts() const { return search_.parts(); }

  template <class C>
  void operator()(const chunked<C>& chunks, const std::vector<point_range>& ranges,
                  std::span<const Eigen::Isometry3d> poses, const Eigen::Isometry3d& pose, min_distance_result& result,
                  std::span<part_minimum> minima, std::vector<scan::boxed_piece>* seen) {
    const C& cloud = chunks.cloud();
    const std::vector<turn> turns = put_together(chunks, ranges);
    const auto load = [&](std::size_t k) { return load_part(cloud, ranges, turns[k], room_[k % 2]); };
    using part = decltype(load(0));
    std::future<part> ahead;
    const auto next = [&](std::size_t k) {
      const auto make = [&](const part& source) {
        scan::boxed_piece* const to =
            seen == nullptr || turns[k].points == 0 ? nullptr : seen->data() + numbers_[turns[k].piece];
        if constexpr (capsule_source<part>) {  // a scan sees no boxes around capsules
          if (to != nullptr) scan::box_points(source, to);
          return placed<part>{source, pose};
        } else {
          const scan::boxing<part> boxing{source, to};
          boxing.add_rest();
          return placed<scan::boxing<part>>{boxing, pose};
        }
      };
      if constexpr (requires { requires C::in_place; }) return make(load(k));
      const part source = k == 0 ? load(0) : ahead.get();
      if (k + 1 < turns.size()) ahead = std::async(std::launch::async, load, k + 1);
      return make(source);
    };
    search_(poses, as_they_come(turns.size(), next), &result, minima.empty() ? nullptr : minima.data());
    number_as_in_cloud(result, minima, [&](std::uint32_t k, std::uint32_t i) {
      return numbers_[turns[k].piece + i / scan::piece_points] * std::uint32_t(scan::piece_points) +
             i % std::uint32_t(scan::piece_points);
    });
  }

 private:
  /// Ranges that are searched as one, its pieces' numbers from `numbers_[piece]` on.
  struct turn {
    std::size_t first, last, piece, points;
  };
  template <class C>
  std::vector<turn> put_together(const chunked<C>& chunks, const std::vector<point_range>& ranges) {
    const std::size_t most = requires { requires C::in_place; } ? none : chunks.chunk();
    std::vector<turn> turns;
    numbers_.clear();
    for (std::size_t r = 0; r < ranges.size(); ++r) {
      const std::size_t points = ranges[r].end - ranges[r].begin;
      if (!addressed_cloud<C> || turns.empty() || turns.back().points + points > most)
        turns.push_back({r, r, numbers_.size(), 0});
      turns.back().last = r + 1, turns.back().points += points;
      for (std::size_t at = ranges[r].begin; at < ranges[r].end; at += scan::piece_points)
        numbers_.push_back(std::uint32_t(at / scan::piece_points));
    }
    return turns;
  }

  struct alignas(64) cache_line {
    std::byte bytes[64];
  };
  template <class C>
  auto load_part(const C& cloud, const std::vector<point_range>& ranges, const turn& its,
                 std::vector<cache_line>& room) const {
    std::size_t bytes = 0;
    for (std::size_t r = its.first; r < its.last; ++r)
      bytes = std::max(bytes, cloud.room(ranges[r].end - ranges[r].begin));
    room.resize((bytes + sizeof(cache_line) - 1) / sizeof(cache_line));
    std::byte* const memory = room.empty() ? nullptr : room[0].bytes;
    if constexpr (addressed_cloud<C>) {
      for (std::size_t r = its.first; r < its.last; ++r) load_range(cloud, ranges[r], memory);
      return scan::listed_pieces<std::remove_cvref_t<decltype(cloud.whole())>>{cloud.whole(),
                                                                               numbers_.data() + its.piece, its.points};
    } else {
      return load_range(cloud, ranges[its.first], memory);
    }
  }

  host_search<PartView> search_;
  std::vector<std::uint32_t> numbers_;  ///< Of the pieces that are asked about.
  std::vector<cache_line> room_[2];
};

/// As `query`, for a chunked cloud.
template <class On, class PartView, class Q>
class chunks {
 public:
  chunks(const On& on, const model_view<PartView>& model) : facts_(model.facts), search_(on, model) {}

  template <class C>
  typename Q::result run(std::span<const Eigen::Isometry3d> poses, chunked<C>& cloud, const Eigen::Isometry3d& pose,
                         const Q&) {
    std::vector<part_minimum> minima(Q::per_part ? search_.parts() : 0);
    loaded_ = 0;
    const min_distance_result all = ask_chunked(
        cloud, facts_, poses, pose, minima,
        [&](const std::vector<point_range>& ranges, min_distance_result& result, std::vector<scan::boxed_piece>* seen) {
          search_(cloud, ranges, poses, pose, result, minima, seen);
          for (const point_range& r : ranges) loaded_ += r.end - r.begin;
        });
    if constexpr (Q::per_part)
      return {all, std::move(minima)};
    else
      return all;
  }
  std::uint64_t loaded() const { return loaded_; }

 private:
  std::span<const part_facts> facts_;
  chunked_search<On, PartView> search_;
  std::uint64_t loaded_ = 0;
};

}  // namespace clearance::minimum
