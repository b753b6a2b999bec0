// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions about a cloud that is read in chunks, because it is larger than memory.

#include <clearance/minimum/chunked_search.hpp>
#include <clearance/query/pieces.hpp>
#include <clearance/query/query.hpp>

#if defined(__CUDACC__)
#include <clearance/minimum/chunked_device.cuh>
#endif

namespace clearance {

namespace detail {

/// Asks about each chunk, while the next one is loaded. A `skipping_question` needs only the chunks within reach, once
/// the host has read the whole cloud.
template <class Q, class On, class PartView>
class chunk_engine {
 public:
  template <class Robot>
  chunk_engine(const On& on, const Robot& robot, const Q& q) : facts_(facts_of(robot)), query_(on, robot, q) {}

  template <class C>
  typename Q::result run(std::span<const Eigen::Isometry3d> poses, chunked<C>& cloud, const Eigen::Isometry3d& pose,
                         const Q& q) {
    // A device's clouds in place, and radii that it reads, may not be read here.
    constexpr bool on_host =
        std::is_same_v<On, host> || (!requires { requires C::in_place; } && !capsule_source<loaded_source<C>>);
    constexpr bool skips = on_host && skipping_question<Q>;
    const bool first = cloud.pieces().empty();
    std::vector<point_range> ranges = cloud.all();
    if constexpr (skips)
      if (!first && !facts_.empty()) ranges = near(poses, cloud, pose, q);
    if (ranges.empty()) ranges.push_back({0, 0});
    joined_of<Q, PartView> all(q, facts_);
    std::vector<scan::boxed_piece> seen(skips && first ? (cloud.size() + scan::piece_points - 1) / scan::piece_points
                                                       : 0);
    std::future<loaded_source<C>> ahead;
    const auto load = [&](std::size_t k) {
      auto& room = room_[k % 2];
      room.resize((cloud.cloud().bytes_for(ranges[k].end - ranges[k].begin) + sizeof(line) - 1) / sizeof(line));
      return minimum::load_range(cloud.cloud(), ranges[k], room.empty() ? nullptr : room[0].bytes);
    };
    loaded_ = 0;
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      const auto source = k == 0 ? load(0) : ahead.get();
      if (k + 1 < ranges.size()) ahead = std::async(std::launch::async, load, k + 1);
      const std::uint32_t begin = std::uint32_t(ranges[k].begin), count = std::uint32_t(source.size()),
                          whole = std::uint32_t(cloud.size());
      all.add(query_(poses, placed<loaded_source<C>>{source, pose}, q), {{&begin, 1}, {&count, 1}, {&whole, 1}});
      if constexpr (skips)
        if (first) scan::box_points(source, seen.data() + begin / scan::piece_points);
      loaded_ += count;
    }
    typename Q::result result = all.result();
    if constexpr (skips) {
      if (first) cloud.keep(std::move(seen));
      if (!facts_.empty()) Q::set_counts(result, cloud.counts());
    }
    return result;
  }
  std::uint64_t loaded() const { return loaded_; }

 private:
  struct alignas(64) line {
    std::byte bytes[64];
  };

  /// The ranges within reach of some part.
  template <class C>
  std::vector<point_range> near(std::span<const Eigen::Isometry3d> poses, const chunked<C>& cloud,
                                const Eigen::Isometry3d& pose, const Q& q) const {
    const auto none_of_it = minimum::load_range(cloud.cloud(), point_range{0, 0}, nullptr);
    const frames::cloud_frame frame(facts_, poses, pose, rounding_of(none_of_it));
    return cloud.where([&](const scan::boxed_piece& seen) {
      const extent box = seen.box_from(frame.origin);
      for (std::size_t k = 0; k < facts_.size(); ++k) {
        const real reach = q.reach(k, facts_.size(), facts_[k], frame.error) + seen.wide;
        if (scan::may_reach(frame.places[k].around, reach, box)) return true;
      }
      return false;
    });
  }

  std::span<const part_facts> facts_;
  query<Q, On, PartView> query_;
  std::vector<line> room_[2];
  std::uint64_t loaded_ = 0;
};

template <class Q, class On, class PartView>
struct chunk_engine_of {
  using type = chunk_engine<Q, On, PartView>;
};
template <class Q, class On, class PartView>
  requires(!is_plain<On> && !is_several<On> && chunking_question<Q>)
struct chunk_engine_of<Q, On, PartView> {
  /// With the robot where it is asked.
  struct type : one_robot<On, PartView>, Q::template chunks<On, PartView> {
    template <class Robot>
    type(const On& on, const Robot& robot, const Q&)
        : one_robot<On, PartView>(on, robot), Q::template chunks<On, PartView>(on, one_robot<On, PartView>::view()) {}
  };
};

}  // namespace detail

/// A prepared question about a `chunked` cloud. The answer is that of `ask` about the whole cloud in memory, to the
/// bit. The robot must outlive the object; use it from one thread.
template <question Q, class On, class PartView>
class chunked_query {
 public:
  /// Throws std::invalid_argument as `query`.
  template <class Robot>
  chunked_query(const On& on, const Robot& robot, const Q& asked) : engine_(on, robot, asked), asked_(asked) {
    [[maybe_unused]] constexpr bool asked_so =
        decltype(refusal_of_form<Q, form::in_chunks, On>())::template explain<Q, On>();
  }
  template <owning_robot Robot>
  chunked_query(const On&, const Robot&&, const Q&) = delete;  // the robot would be gone when it is asked; name it

  /// As `query`; `pose` is world-from-cloud. Throws what `load` throws; afterwards you can ask the same object again.
  template <class Poses, loaded_cloud C>
  typename Q::result operator()(const Poses& poses, chunked<C>& cloud, const Eigen::Isometry3d& pose, const Q& q) {
    if constexpr (explain_combination<Q, loaded_source<C>, form::in_chunks, On>()) {
      const detail::in_use::call only(used_);
      return engine_.run(detail::as_poses(poses), cloud, pose, q);
    }
  }
  template <class Poses, loaded_cloud C>
  typename Q::result operator()(const Poses& poses, chunked<C>& cloud,
                                const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
    return (*this)(poses, cloud, pose, asked_);
  }

  /// Other clouds are refused with a sentence.
  template <class Poses, clouds_of_any_kind Clouds, class... Others>
  void operator()(const Poses&, const Clouds&, const Others&...) {
    refusals::clouds_in_chunks::explain<Clouds>();
  }

  /// How many points the last answer loaded.
  std::uint64_t loaded() const { return engine_.loaded(); }

 private:
  typename detail::chunk_engine_of<Q, On, PartView>::type engine_;
  Q asked_;
  detail::in_use used_;
};
template <class On, class Robot, class Q>
chunked_query(const On&, const Robot&, const Q&) -> chunked_query<Q, On, typename detail::part_view_of<Robot>::type>;

}  // namespace clearance
