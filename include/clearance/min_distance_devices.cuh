// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from everything that its sensors see? Runs on several devices at once: each is asked about a piece
// of every cloud.

#include <clearance/answer/of_pieces.hpp>
#include <clearance/backend/devices.cuh>
#include <clearance/backend/kept_pinned.cuh>
#include <clearance/backend/shards.cuh>
#include <clearance/min_distance_query.cuh>
#include <clearance/robot/replicas.hpp>
#include <clearance/scan/interior.hpp>

#include <deque>

namespace clearance {

/// The prepared question on several devices: one on each, about its piece of every cloud, and one answer from all,
/// which is that of one device, to the bit. The robot is on each device (`model.on(devices)`). Clouds in host memory
/// (and in another device's) are copied in slices, one to each device; `shard`ed clouds are read where they are. Pinned
/// memory is copied to all devices at once.
template <class PartView>
class min_distance_query<devices, PartView> {
 public:
  /// `memory`: nothing, or for each device a resource that hands out its memory; `pinned`: a resource that hands out
  /// pinned memory. Throws std::invalid_argument if the robot is not on these devices, and as on one device.
  template <robot Robot>
  min_distance_query(const devices& on, const Robot& robot, std::span<std::pmr::memory_resource* const> memory = {},
                     std::pmr::memory_resource* pinned = nullptr)
      : on_(on) {
    const auto view = view_of(robot);
    static_assert(requires { view.each; }, "several devices take a robot that is on each of them: model.on(devices)");
    check(view.each, memory.size());
    for (std::size_t k = 0; k < on.size(); ++k)
      each_.emplace_back(on.each()[k], view.each[k], memory.empty() ? nullptr : memory[k], pinned);
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    for (auto& query : each_) query.forget();
  }

  /// One frame; blocks until the answer is there. Throws std::invalid_argument as min_distance, and if a cloud is in
  /// more or fewer shards than there are devices.
  template <class... Clouds>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds&... clouds) {
    return ask<false>(poses, as_clouds(clouds...));
  }
  /// As min_distance_per_part; writes `minima`, one per part.
  template <class Clouds>
  min_distance_result per_part(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                               std::span<part_minimum> minima) {
    frames::check_room(each_[0].minima_.size(), minima.size());
    const min_distance_result all = ask<true>(poses, clouds);
    std::ranges::fill(minima, part_minimum{});
    for (std::size_t k = 0; k < each_.size(); ++k)
      for (std::size_t part = 0; part < minima.size(); ++part)
        minima[part] = merge(minima[part], in_whole(each_[k].minima_.data()[part], k));
    return all;
  }

 private:
  void check(std::span<const model_view<PartView>> copies, std::size_t resources) const {
    if (copies.size() != on_.size())
      throw std::invalid_argument("clearance: the robot is on " + std::to_string(copies.size()) + " devices, but " +
                                  std::to_string(on_.size()) + " are asked");
    if (resources != 0 && resources != on_.size())
      throw std::invalid_argument("clearance: " + std::to_string(resources) + " memory resources for " +
                                  std::to_string(on_.size()) + " devices");
    for (std::size_t k = 0; k < copies.size(); ++k)
      if (const device& on = on_.each()[k]; !on.holds(copies[k].parts))
        throw std::invalid_argument("clearance: the robot is not on device " + std::to_string(on.id) +
                                    ", which is asked");
  }

  template <bool PerPart, class Clouds>
  min_distance_result ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    static_assert(explain_clouds<Clouds>());
    const std::size_t n = each_.size();
    std::uint64_t seen = 0;
    first_.clear();
    for_each_cloud(clouds, [&](const auto& cloud, const Eigen::Isometry3d&) {
      check_pieces(cloud, n);
      for (std::size_t k = 0; k < n; ++k) first_.push_back(std::uint32_t(first_of_piece(cloud, k, n)));
      seen += cloud.size();
    });
    try {
      for (std::size_t k = 0; k < n; ++k)
        each_[k].template begin<PerPart>(poses, clouds, [k, n](const auto& cloud) { return piece_of(cloud, k, n); });
      for (auto& query : each_) query.answered();
    } catch (...) {
      on_.wait_for_all();  // those that have begun read the caller's memory, and write into ours
      throw;
    }
    minimum::of_pieces pieces(in_whole(each_[0].answered(), 0));
    for (std::size_t k = 1; k < n; ++k) pieces.add(minimum::of_pieces(in_whole(each_[k].answered(), k)));
    min_distance_result all = pieces.answer(scan::has_interior<PartView>);
    all.seen = all.valid = seen;  // a device has numbered the points of all pieces
    for (const std::uint64_t dropped : all.dropped) all.valid -= dropped;
    return all;
  }

  /// A piece's answer in the numbers of the whole clouds.
  template <class Answer>
  Answer in_whole(const Answer& r, std::size_t k) const {
    return r.cloud == none ? r : renumbered(r, 0, first_[r.cloud * each_.size() + k]);
  }

  devices on_;
  std::deque<min_distance_query<device, PartView>> each_;
  std::vector<std::uint32_t> first_;  ///< The number of the first point, for every cloud and piece.
};

template <robot Robot>
min_distance_query(const devices&, const Robot&, std::span<std::pmr::memory_resource* const>)
    -> min_distance_query<devices, typename decltype(view_of(std::declval<const Robot&>()))::part_type>;

namespace minimum {

/// A prepared question for one call. Its answer is in host memory.
template <>
struct search_on<devices> {
  static host backend_of(const devices&) { return {}; }

  template <bool PerPart, class PartView, class Clouds, class Here>
  static void once(const devices& on, const replicas_view<PartView>& robot, std::span<const Eigen::Isometry3d> poses,
                   const Clouds& clouds, min_distance_result* result, part_minimum* minima, const Here&) {
    static_assert(!std::is_same_v<Here, as_it_is>,
                  "several devices have no one stream to enqueue in: their answer is waited for");
    std::deque<stream_resource> memory;
    std::vector<std::pmr::memory_resource*> of_each;
    for (const device& its : on.each()) of_each.push_back(&memory.emplace_back(its.id, its.stream));
    min_distance_query<devices, PartView> query(on, robot, of_each, kept_pinned());
    if constexpr (PerPart)
      *result = query.per_part(poses, clouds, std::span(minima, robot.size()));
    else
      *result = query(poses, clouds);
  }
  template <bool PerPart, class PartView, class Clouds, class Here>
  static void once(const devices&, const model_view<PartView>&, std::span<const Eigen::Isometry3d>, const Clouds&,
                   min_distance_result*, part_minimum*, const Here&) {
    static_assert(!sizeof(PartView), "several devices take a robot that is on each of them: model.on(devices)");
  }
};

}  // namespace minimum

}  // namespace clearance
