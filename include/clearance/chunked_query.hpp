// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from a cloud that is read in chunks? On the host; chunked_query.cuh has a device, too.

#include <clearance/answer/chunked.hpp>
#include <clearance/answer/host_search.hpp>

#include <future>

namespace clearance {

/// The question about a `chunked` cloud: min_distance's, with min_distance's answer about all of it in memory, to the bit. While one chunk
/// is searched the next is loaded. One object is for one thread.
template <class On, class PartView>
class chunked_query {
  static_assert(!requires { typename On::own_scan; }, "a device has a ring of its own: include <clearance/chunked_query.cuh>, not the .hpp");
};

/// On the CPU. The robot's memory must stay.
template <class PartView>
class chunked_query<host, PartView> {
 public:
  template <robot Robot>
  chunked_query(const host& on, const Robot& robot) : facts_(view_of(robot).facts), search_(on, view_of(robot)) {}

  /// As min_distance; `pose` is world-from-cloud. Throws what `load` throws; the same object can be asked again then.
  template <loaded_cloud C>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, chunked<C>& cloud, const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
    return ask(poses, cloud, pose, {});
  }
  /// As min_distance_per_part; `minima`, one a part, are written.
  template <loaded_cloud C>
  min_distance_result per_part(std::span<const Eigen::Isometry3d> poses, chunked<C>& cloud, const Eigen::Isometry3d& pose, std::span<part_minimum> minima) {
    frames::check_room(search_.parts(), minima.size());
    return ask(poses, cloud, pose, minima);
  }

  /// How many points the last answer loaded.
  std::uint64_t loaded() const { return loaded_; }

 private:
  template <class C>
  min_distance_result ask(std::span<const Eigen::Isometry3d> poses, chunked<C>& cloud, const Eigen::Isometry3d& pose, std::span<part_minimum> minima) {
    loaded_ = 0;
    return minimum::ask_chunked(cloud, facts_, poses, pose, minima,
                                [&](const std::vector<point_range>& ranges, min_distance_result& result, std::span<part_minimum> of_parts,
                                    std::vector<scan::boxed_piece>* seen) {
                                  search(cloud.cloud(), ranges, poses, pose, result, of_parts.empty() ? nullptr : of_parts.data(), seen);
                                });
  }

  template <class C>
  void search(const C& cloud, const std::vector<point_range>& ranges, std::span<const Eigen::Isometry3d> poses, const Eigen::Isometry3d& pose,
              min_distance_result& result, part_minimum* minima, std::vector<scan::boxed_piece>* seen) {
    constexpr bool in_place = requires { requires C::in_place; };
    std::future<loaded_source<C>> ahead;
    const auto load = [&](std::size_t k) {
      std::vector<cache_line>& room = room_[k % 2];
      room.resize((cloud.room(ranges[k].end - ranges[k].begin) + sizeof(cache_line) - 1) / sizeof(cache_line));
      return cloud.load(ranges[k].begin, ranges[k].end, room.empty() ? nullptr : room[0].bytes);
    };
    const auto next = [&](std::size_t k) {
      const auto make = [&](const loaded_source<C>& source) {
        const point_range range = ranges[k];
        loaded_ += range.end - range.begin;
        const scan::boxing<loaded_source<C>> boxing{source, seen == nullptr ? nullptr : seen->data() + range.begin / scan::piece_points};
        boxing.add_rest();
        return placed<scan::boxing<loaded_source<C>>>{boxing, pose};
      };
      if constexpr (in_place) return make(load(k));
      const loaded_source<C> source = k == 0 ? load(0) : ahead.get();
      if (k + 1 < ranges.size()) ahead = std::async(std::launch::async, load, k + 1);
      return make(source);
    };
    search_(poses, minimum::as_they_come(ranges.size(), next), &result, minima);
  }

  struct alignas(64) cache_line {
    std::byte bytes[64];
  };

  std::span<const part_facts> facts_;
  minimum::host_search<PartView> search_;
  std::vector<cache_line> room_[2];
  std::uint64_t loaded_ = 0;
};

template <class On, robot Robot>
chunked_query(const On&, const Robot&) -> chunked_query<On, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

}  // namespace clearance
