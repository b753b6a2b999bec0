// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A question that is prepared for a robot, behind an interface: asked about one frame, many worlds or a motion, by any
// number of threads, or enqueued.

#include "clouds.hpp"
#include "enqueued.hpp"
#include "questions.hpp"
#include "robot.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/motion_clearance.hpp>

#include <algorithm>
#include <mutex>
#include <optional>

namespace clearance::python {

/// A cloud as it is asked about: relative to a place near the robot.
struct seen_cloud {
  any_cloud cloud;
  const std::optional<cloud_doubts> doubts;
  const point_label* labels = nullptr;  ///< Of its points, if it is masked.
};

/// What is asked about: where the robot is, and what is seen.
struct asked_frame {
  std::vector<Eigen::Isometry3d> places;
  std::vector<std::size_t> shape;  ///< Of the configurations.
  std::vector<seen_cloud> seen;
  nb::list kept;
  bool on_device = false;
};

/// The names of the questions about uncertain clouds.
inline std::string takers_of_uncertain() {
  std::vector<std::string> names;
  for_each_declared([&]<class T>() {
    if constexpr (declared<T>::question)
      if (!std::is_same_v<typename cloud_about<T>::type, any_cloud>) names.emplace_back(declared<T>::name);
  });
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  return text;
}

/// Throws std::invalid_argument if a cloud is uncertain, and Q is not about that.
template <class Q>
clouds_about<Q> clouds_for(const std::vector<seen_cloud>& seen) {
  clouds_about<Q> made;
  for (const seen_cloud& each : seen)
    std::visit(
        [&]<class S>(const placed<S>& bare) {
          if (!each.doubts)
            made.push_back(bare);
          else if constexpr (std::is_constructible_v<typename cloud_about<Q>::type, any::placed_uncertain<S>>)
            made.push_back(placed{uncertain(bare.source, each.doubts->noise, each.doubts->of), bare.pose});
          else
            throw std::invalid_argument(std::string("clearance: a cloud is uncertain, and in Python ") +
                                        declared<Q>::name + " takes points where they were measured; " +
                                        takers_of_uncertain() + " take uncertain ones");
        },
        each.cloud);
  return made;
}

/// One answer about several worlds, one after another: what a question about many configurations answers.
template <class Q>
struct of_worlds;
template <>
struct of_worlds<min_distance> {
  using type = min_distances_result;
  static void add(type& all, const min_distance_result& one) { all.of.push_back(one); }
};
template <>
struct of_worlds<min_distances> {
  using type = min_distances_result;
  static void add(type& all, const type& one) { all.of.insert(all.of.end(), one.of.begin(), one.of.end()); }
};
template <>
struct of_worlds<in_collision> {
  using type = in_collisions_result;
  static void add(type& all, const collision_result& one) {
    all.of.push_back(one.state);
    all.counts.add(one.counts);
  }
};
template <>
struct of_worlds<in_collisions> {
  using type = in_collisions_result;
  static void add(type& all, const type& one) {
    all.of.insert(all.of.end(), one.of.begin(), one.of.end());
    all.counts.add(one.counts);
  }
};

/// Is Q about many configurations?
template <class Q>
inline constexpr bool asks_many = requires { typename Q::searched; };

/// A query in Python, whatever its question.
struct any_query {
  virtual ~any_query() = default;
  virtual bool about_many() const = 0;  ///< Configurations.
  virtual nb::object ask(const asked_frame& frame, nb::handle question, std::optional<void*> stream) = 0;
  virtual nb::object worlds(const std::vector<asked_frame>& frames, nb::handle question,
                            std::optional<void*> stream) = 0;
  virtual nb::object enqueue(std::span<const Eigen::Isometry3d> poses, const std::vector<seen_cloud>& clouds,
                             nb::handle question, void* stream, nb::handle out, std::optional<std::size_t> capacity,
                             nb::object kept) = 0;
};

/// Any number of threads may ask: each takes a prepared question that no other has, or a new one.
template <class Q>
class query_of final : public any_query {
 public:
  query_of(std::shared_ptr<robot_model> robot, const Q& question, int device, unsigned threads)
      : robot_(std::move(robot)), standing_(question), device_(device), threads_(threads) {
    check_options();
    idle_.push_back(make());
  }

  bool about_many() const override { return asks_many<Q>; }

  nb::object ask(const asked_frame& frame, nb::handle question, std::optional<void*> stream) override {
    const Q asked = question.is_none() ? standing_ : other(question);
    const clouds_about<Q> seen = clouds_for<Q>(frame.seen);
    const auto labels = labels_of(frame.seen);
    typename Q::result result;
    {
      const nb::gil_scoped_release others;
      const auto mine = take();
      if (stream) mine->after(*stream);
      result = labels.empty() ? (*mine)(frame.places, seen, asked) : mine->masked(frame.places, seen, labels, asked);
      give_back(mine);
    }
    if constexpr (declared_struct<typename Q::result>) {
      return nb::cast(
          answered<typename Q::result>{std::move(result), {robot_->names, digest_of(frame.places), frame.shape}});
    } else {
      using element = typename Q::result::value_type;
      auto* const kept = new typename Q::result(std::move(result));
      return array_of<element>(kept->data(), kept->size(),
                               nb::capsule(kept, [](void* p) noexcept { delete static_cast<typename Q::result*>(p); }));
    }
  }

  nb::object enqueue(std::span<const Eigen::Isometry3d> poses, const std::vector<seen_cloud>& clouds,
                     nb::handle question, void* stream, nb::handle out, std::optional<std::size_t> capacity,
                     nb::object kept) override {
    if constexpr (can_be_enqueued<Q>) {
      const Q asked = question.is_none() ? standing_ : other(question);
      if (!labels_of(clouds).empty())
        throw std::invalid_argument(
            "clearance: a cloud is masked, which a query on the cpu takes; give the points that are left");
      const std::size_t parts = robot_->parts();
      const clouds_about<Q> seen = clouds_for<Q>(clouds);
      const room_sizes sizes{count_points(seen), parts, parts == 0 ? 0 : poses.size() / parts, {}};
      const auto mine = [this] {
        const nb::gil_scoped_release others;
        return take();
      }();
      enqueued_answer answer{{}, {}, device_, mine->stream(), mine, std::move(kept), {}};
      const auto to = arrays_for(asked, sizes, capacity, out, *mine, answer);
      {
        const nb::gil_scoped_release others;
        answer.certain = mine->enqueue(poses, seen, asked, to, stream);
      }
      for (const auto& memory : answer.rewritten) memory->stream = answer.stream, memory->writer = mine;
      give_back(mine);
      return nb::cast(std::move(answer));
    } else {
      throw std::invalid_argument(std::string("clearance: ") + declared<Q>::name +
                                  " cannot be enqueued, because the host decides while it is answered; call the query");
    }
  }

  nb::object worlds(const std::vector<asked_frame>& frames, nb::handle question, std::optional<void*> stream) override {
    if constexpr (requires { typename of_worlds<Q>::type; }) {
      const Q asked = question.is_none() ? standing_ : other(question);
      std::vector<clouds_about<Q>> seen;
      std::vector<Eigen::Isometry3d> places;
      std::vector<std::size_t> shape{frames.size()};
      for (const asked_frame& frame : frames) {
        seen.push_back(clouds_for<Q>(frame.seen));
        places.insert(places.end(), frame.places.begin(), frame.places.end());
        if (frame.shape != frames[0].shape)
          throw std::invalid_argument("clearance: world " + std::to_string(&frame - frames.data()) +
                                      " has another number of configurations than world 0");
      }
      if (asks_many<Q> && !frames.empty()) shape.insert(shape.end(), frames[0].shape.begin(), frames[0].shape.end());
      typename of_worlds<Q>::type all;
      {
        const nb::gil_scoped_release others;
        std::vector<typename Q::result> each(frames.size());
        const auto some = [&](const indices& numbers) {
          const auto mine = take();
          if (stream) mine->after(*stream);
          for (std::size_t w = numbers.begin; w < numbers.end; w += numbers.step)
            each[w] = answer(*mine, frames[w], seen[w], asked, w);
          give_back(mine);
        };
        if (device_ == on_the_host)
          host{.threads = threads_}.for_ranges(frames.size(), some, 1);
        else
          some({0, frames.size(), 1});
        for (const auto& one : each) of_worlds<Q>::add(all, one);
      }
      return nb::cast(answered<typename of_worlds<Q>::type>{std::move(all), {robot_->names, digest_of(places), shape}});
    } else {
      throw std::invalid_argument(std::string("clearance: of many worlds are asked MinDistance, MinDistances, "
                                              "InCollision and InCollisions, not ") +
                                  declared<Q>::name);
    }
  }

  /// A lower bound over a motion, by questions about each part at some of its times.
  template <motion Motion>
  motion_clearance_result over(const Motion& motion, const asked_frame& frame, const motion_clearance_options& options,
                               std::optional<void*> stream)
    requires std::same_as<Q, min_distance_per_part>
  {
    const clouds_about<Q> seen = clouds_for<Q>(frame.seen);
    const auto labels = labels_of(frame.seen);
    const nb::gil_scoped_release others;
    const auto mine = take();
    if (stream) mine->after(*stream);
    typename Q::result found;
    const auto at = [&](std::span<const Eigen::Isometry3d> poses) -> const auto& {
      return found = labels.empty() ? (*mine)(poses, seen, standing_) : mine->masked(poses, seen, labels, standing_);
    };
    const auto result = std::visit(
        [&](const auto& trees) { return detail::over_motion(at, trees.view().facts, motion, seen, options); },
        *robot_->trees);
    give_back(mine);
    return result;
  }

 private:
  /// The labels of each cloud, or null; empty if no cloud is masked.
  static std::vector<const point_label*> labels_of(const std::vector<seen_cloud>& clouds) {
    std::vector<const point_label*> all;
    for (const seen_cloud& each : clouds) all.push_back(each.labels);
    if (std::ranges::all_of(all, [](const auto* labels) { return labels == nullptr; })) all.clear();
    return all;
  }
  static typename Q::result answer(asker<Q>& its, const asked_frame& frame, const clouds_about<Q>& seen, const Q& asked,
                                   std::size_t world) {
    try {
      const auto labels = labels_of(frame.seen);
      return labels.empty() ? its(frame.places, seen, asked) : its.masked(frame.places, seen, labels, asked);
    } catch (const std::invalid_argument& error) {
      const std::string_view why = error.what(), ours = "clearance: ";
      throw std::invalid_argument("clearance: world " + std::to_string(world) + ": " +
                                  std::string(why.starts_with(ours) ? why.substr(ours.size()) : why));
    }
  }
  static Q other(nb::handle question) {
    if (!nb::isinstance<asked<Q>>(question))
      throw nb::type_error((std::string("this query asks ") + declared<Q>::name + ", and question is a " +
                            nb::cast<std::string>(question.type().attr("__name__")))
                               .c_str());
    return nb::cast<const asked<Q>&>(question).question;
  }
  /// Throws what asking would throw about options that no frame could mend: it asks about a frame without points.
  void check_options() const {
    if constexpr (!any::is_about<Q, sphere_model<>>())
      if (robot_->spheres)
        throw std::invalid_argument(std::string("clearance: ") + declared<Q>::name +
                                    " is about robots of triangles (model=\"triangles\"), and this one has spheres");
    Q q = standing_;
    if constexpr (requires { q.labels; }) q.labels = {};  // of a frame's points
    if constexpr (!requires { q.minima; })                // of a frame's pairs
      (*ask_on_host(robot_->trees, q, 1))(std::vector(robot_->parts(), Eigen::Isometry3d::Identity()), {}, q);
  }
  std::shared_ptr<asker<Q>> make() const {
    if (device_ == on_the_host) return ask_on_host(robot_->trees, standing_, threads_);
    return ask_on_device(*robot_, standing_, device_);
  }
  std::shared_ptr<asker<Q>> take() {
    {
      const std::scoped_lock lock(mutex_);
      if (!idle_.empty()) {
        auto one = std::move(idle_.back());
        idle_.pop_back();
        return one;
      }
    }
    return make();
  }
  void give_back(std::shared_ptr<asker<Q>> one) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(one));
  }

  std::shared_ptr<robot_model> robot_;
  Q standing_;
  int device_;
  unsigned threads_;
  std::mutex mutex_;
  std::vector<std::shared_ptr<asker<Q>>> idle_;
};

}  // namespace clearance::python
