// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks on several devices at once: each about a piece of every cloud.

#include <clearance/backends/device_buffer.cuh>
#include <clearance/backends/devices.cuh>
#include <clearance/backends/one_call.cuh>
#include <clearance/query/pieces.hpp>
#include <clearance/query/query.hpp>
#include <clearance/robot/replicas.hpp>

#include <deque>
#include <future>

namespace clearance {

namespace detail {

/// Memory for one call, on each of the devices.
template <>
struct one_call<devices> {
  template <class Ask>
  static auto of(const devices& on, const Ask& ask) {
    std::deque<stream_resource> memory;
    std::vector<std::pmr::memory_resource*> of_each;
    for (const device& its : on.each()) of_each.push_back(&memory.emplace_back(its.id, its.stream));
    return ask(std::span<std::pmr::memory_resource* const>(of_each));
  }
};

}  // namespace detail

/// A prepared question on several devices, and one answer from all, which is that of one device, to the bit. The robot
/// is on each device (`model.on(devices)`). Clouds in host memory (and in another device's) are copied in slices, one
/// to each device; `shard`ed clouds are read where they are. Pinned memory is copied to all devices at once.
template <question Q, class PartView>
class query<Q, devices, PartView> : public detail::callable<query<Q, devices, PartView>, devices, Q> {
 public:
  /// `memory`: nothing, or for each device a resource that hands out its memory; `pinned`: a resource that hands out
  /// pinned memory. Throws std::invalid_argument if the robot is not on these devices, and as on one device.
  template <class Robot>
  query(const devices& on, const Robot& robot, const Q& asked, std::span<std::pmr::memory_resource* const> memory = {},
        std::pmr::memory_resource* pinned = kept_pinned())
      : detail::callable<query, devices, Q>(asked), on_(on) {
    static_assert(
        requires { robot.view().each; }, "several devices take a robot that is on each of them: model.on(devices)");
    if constexpr (requires { robot.view().each; }) {
      const auto view = robot.view();
      check(view.each, memory.size());
      facts_ = view.facts;
      for (std::size_t k = 0; k < on.size(); ++k) {
        std::pmr::memory_resource* const its = memory.empty() ? nullptr : memory[k];
        if constexpr (pinning_engine<one>)
          each_.emplace_back(on.each()[k], view.each[k], asked, its, pinned);
        else
          each_.emplace_back(on.each()[k], view.each[k], asked, its);
      }
    }
  }
  template <owning_robot Robot, class... Memory>
  query(const devices&, const Robot&&, const Q&,
        Memory...) = delete;  // the robot would be gone when it is asked; name it

  /// Throws std::invalid_argument also if a cloud is in more or fewer shards than there are devices.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    const std::size_t n = each_.size();
    for_each_cloud(clouds, [&](const auto& cloud, const Eigen::Isometry3d&) { check_pieces(cloud, n); });
    numbers_.count(clouds);
    detail::joined_of<Q, PartView> all(q, facts_);
    const auto piece = [&](std::size_t k) { return mapped_clouds(clouds, detail::one_piece{k, n}); };
    const auto place = [&](std::size_t k) { return numbers_.place(clouds, detail::one_piece{k, n}); };
    if constexpr (!waiting_engine<one>) {
      try {
        for (std::size_t k = 0; k < n; ++k) each_[k].begin(poses, piece(k), q);
        for (std::size_t k = 0; k < n; ++k) all.add(each_[k].finish(), place(k));
      } catch (...) {
        on_.wait_for_all();  // those that have begun read the caller's memory, and write into ours
        throw;
      }
    } else {
      std::vector<std::future<typename Q::result>> found;
      for (std::size_t k = 0; k < n; ++k)
        found.push_back(
            std::async(std::launch::async, [&, k] { return typename Q::result(each_[k](poses, piece(k), q)); }));
      for (auto& its : found) its.wait();
      for (std::size_t k = 0; k < n; ++k) all.add(found[k].get(), place(k));
    }
    result_ = all.result();
  }
  typename Q::result finish() { return *std::move(result_); }

  template <class... Arguments>
  void enqueue(const Arguments&...) {
    refusals::devices_have_no_stream::explain<Q, Arguments...>();
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    for (one& its : each_) its.forget();
  }

 private:
  using one = query<Q, device, PartView>;

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

  devices on_;
  std::span<const part_facts> facts_;
  std::deque<one> each_;
  detail::piece_numbers numbers_;
  std::optional<typename Q::result> result_;
};

}  // namespace clearance
