// SPDX-License-Identifier: BSD-3-Clause
#include "query.hpp"

#include "arrays.hpp"
#include "clouds.hpp"
#include "enqueued.hpp"
#include "questions.hpp"
#include "robot.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <mutex>
#include <optional>

using namespace clearance;

void refuse_option(const char* question, const char* option, const char* wanted, nb::handle given) {
  const nb::object one_line = nb::str(" ").attr("join")(nb::repr(given).attr("split")());  // arrays have several
  throw nb::type_error(
      (std::string(question) + ": " + option + " is " + wanted + ", not " + nb::cast<std::string>(one_line)).c_str());
}

namespace {

/// A cloud as it is asked about: relative to a place near the robot.
struct seen_cloud {
  any_cloud cloud;
  const std::optional<cloud_doubts> doubts;
};

/// The names of the questions about uncertain clouds.
std::string takers_of_uncertain() {
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

/// Is Q about many configurations?
template <class Q>
inline constexpr bool asks_many = requires { typename Q::searched; };

/// A query in Python, whatever its question.
struct any_query {
  virtual ~any_query() = default;
  virtual bool about_many() const = 0;  ///< Configurations.
  virtual nb::object ask(std::span<const Eigen::Isometry3d> poses, const std::vector<seen_cloud>& clouds,
                         nb::handle question, std::optional<void*> stream) = 0;
  virtual nb::object enqueue(std::span<const Eigen::Isometry3d> poses, const std::vector<seen_cloud>& clouds,
                             nb::handle question, void* stream, nb::handle out, std::optional<std::size_t> capacity,
                             nb::object kept) = 0;
};

/// Any number of threads may ask: each takes a prepared question that no other has, or a new one.
template <class Q>
class query_of final : public any_query {
 public:
  query_of(std::shared_ptr<robot_model> robot, const Q& question, int device)
      : robot_(std::move(robot)), standing_(question), device_(device) {
    check_options();
    idle_.push_back(make());
  }

  bool about_many() const override { return asks_many<Q>; }

  nb::object ask(std::span<const Eigen::Isometry3d> poses, const std::vector<seen_cloud>& clouds, nb::handle question,
                 std::optional<void*> stream) override {
    const Q asked = question.is_none() ? standing_ : other(question);
    const clouds_about<Q> seen = clouds_for<Q>(clouds);
    typename Q::result result;
    {
      const nb::gil_scoped_release others;
      const auto mine = take();
      if (stream) mine->after(*stream);
      result = (*mine)(poses, seen, asked);
      give_back(mine);
    }
    if constexpr (declared_struct<typename Q::result>) {
      return nb::cast(answered<typename Q::result>{std::move(result), {robot_->names, digest_of(poses)}});
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

 private:
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
      (*ask_on_host(robot_->trees, q))(std::vector(robot_->parts(), Eigen::Isometry3d::Identity()), {}, q);
  }
  std::shared_ptr<asker<Q>> make() const {
    if (device_ == on_the_host) return ask_on_host(robot_->trees, standing_);
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
  std::mutex mutex_;
  std::vector<std::shared_ptr<asker<Q>>> idle_;
};

/// What is asked about: where the robot is, and what is seen.
struct asked_frame {
  std::vector<Eigen::Isometry3d> places;
  std::vector<seen_cloud> seen;
  nb::list kept;
  bool on_device = false;
};

struct query_object {
  std::shared_ptr<robot_model> robot;
  nb::object question, kept;
  int device;
  std::unique_ptr<any_query> query;

  query_object(std::shared_ptr<robot_model> robot_, nb::object question_, const std::string& device_)
      : robot(std::move(robot_)), question(std::move(question_)), device(device_number(device_)) {
    if (PyType_Check(question.ptr())) question = question();  // MinDistance for MinDistance()
    for_each_declared([&]<class T>() {
      if constexpr (declared<T>::question)
        if (nb::isinstance<asked<T>>(question))
          query = std::make_unique<query_of<T>>(robot, nb::cast<const asked<T>&>(question).question, device);
    });
    if (!query)
      throw nb::type_error(
          ("question is one of the library's, such as MinDistance(), not " + nb::cast<std::string>(nb::repr(question)))
              .c_str());
  }

  /// `stays`: the device reads clouds where they are, after this.
  asked_frame frame_of(nb::handle points, nb::handle joints, nb::handle poses, nb::handle base, nb::handle cloud_pose,
                       nb::handle depth, nb::handle intrinsics, nb::handle rays, nb::handle depth_scale,
                       nb::handle camera_pose, nb::handle clouds, joint_reading how, bool stays) const {
    asked_frame made;
    auto& places = made.places;
    Eigen::Vector3d middle;
    if (!poses.is_none()) {
      if (!joints.is_none() || !base.is_none() || how.rest)
        throw std::invalid_argument("clearance: poses are given, so joints, base and rest cannot be");
      places = poses_of(poses, "poses");
      middle = places.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(places[0].translation());
    } else {
      middle = pose_of(base, "base").translation();
      auto [at, shape] = robot_at(*robot, joints, base, how);
      places = std::move(at);
      const std::size_t count = robot->parts() == 0 ? 1 : places.size() / robot->parts();
      if (count != 1 && !query->about_many())
        throw std::invalid_argument("clearance: joints gives " + std::to_string(count) + " configurations, so " +
                                    std::to_string(places.size()) + " poses of " + std::to_string(robot->parts()) +
                                    " parts, and " + text_of(question.type().attr("__name__")) +
                                    " asks about one; MinDistances and its kin ask about many");
    }
    const auto put = [&](const cloud_object& cloud, const char* argument) {
      if (cloud.device != on_the_host && device == on_the_host)
        throw std::invalid_argument(std::string("clearance: ") + argument +
                                    " lies on cuda:" + std::to_string(cloud.device) +
                                    ", and this query asks on the cpu; copy it, or make the query for that device");
      if (cloud.device != on_the_host && cloud.device != device)
        throw std::invalid_argument(std::string("clearance: ") + argument +
                                    " lies on cuda:" + std::to_string(cloud.device) +
                                    ", and this query asks on cuda:" + std::to_string(device));
      if (stays && cloud.device == on_the_host &&
          std::visit([](const auto& c) { return c.source.size(); }, cloud.cloud))
        throw std::invalid_argument(std::string("clearance: ") + argument +
                                    " lies on the cpu, and what is enqueued reads the device's memory: give "
                                    "DeviceArray(array, \"" +
                                    device_name(device) + "\") or the like; a call copies by itself");
      const bool radii = cloud.doubts && cloud.doubts->noise.kind == noise_kind::radii;
      if (radii && cloud.doubts->device != device)
        throw std::invalid_argument("clearance: the radii of " + std::string(argument) + " lie on " +
                                    device_name(cloud.doubts->device) + ", and this query asks on " +
                                    device_name(device) + ", which reads them in place");
      made.on_device |= cloud.device != on_the_host || (radii && device != on_the_host);
      made.seen.push_back({near_robot(cloud, middle), cloud.doubts});
      for (const nb::object& memory : {cloud.kept, cloud.also_kept})
        if (memory) made.kept.append(memory);
    };
    if (!points.is_none()) {
      cloud_object* ready = nullptr;
      if (nb::try_cast(points, ready) && ready && !cloud_pose.is_none())
        throw std::invalid_argument("clearance: cloud_pose is given, but this cloud has its own: points(array, pose)");
      if (ready)
        put(*ready, "points");
      else
        put(cloud_of_points(points, cloud_pose, 0, infinity, nb::none(), false), "points");
    } else if (!cloud_pose.is_none()) {
      throw std::invalid_argument("clearance: cloud_pose is given without points");
    }
    if (!depth.is_none())
      put(depth_of(depth, intrinsics, camera_pose, depth_scale, 0, infinity, true, rays), "depth");
    else if (!intrinsics.is_none() || !camera_pose.is_none() || !depth_scale.is_none() || !rays.is_none())
      throw std::invalid_argument(
          "clearance: intrinsics, rays, depth_scale and camera_pose are about depth, which is not given");
    if (!clouds.is_none() &&
        (nb::hasattr(clouds, "dtype") || !nb::hasattr(clouds, "__iter__") || nb::isinstance<nb::str>(clouds)))
      throw std::invalid_argument("clearance: clouds is a sequence of points(...), depth_image(...) and arrays, not " +
                                  shape_and_type(clouds));
    if (!clouds.is_none())
      for (const nb::handle each : clouds) {
        cloud_object* ready = nullptr;
        if (nb::try_cast(each, ready) && ready)
          put(*ready, "one of the clouds");
        else
          put(cloud_of_points(each, nb::none(), 0, infinity, nb::none(), false), "one of the clouds");
      }
    else if (points.is_none() && depth.is_none())
      throw std::invalid_argument("clearance: nothing is given to look at: points, depth or clouds");
    return made;
  }

  nb::object operator()(nb::handle points, nb::handle joints, nb::handle poses, nb::handle base, nb::handle cloud_pose,
                        nb::handle depth, nb::handle intrinsics, nb::handle rays, nb::handle depth_scale,
                        nb::handle camera_pose, nb::handle clouds, nb::handle stream, nb::handle other,
                        bool ignore_limits, bool rest) {
    const asked_frame frame = frame_of(points, joints, poses, base, cloud_pose, depth, intrinsics, rays, depth_scale,
                                       camera_pose, clouds, {ignore_limits, rest}, false);
    return query->ask(frame.places, frame.seen, other, stream_of(stream, frame.on_device));
  }

  nb::object enqueue(nb::handle points, nb::handle joints, nb::handle poses, nb::handle base, nb::handle cloud_pose,
                     nb::handle depth, nb::handle intrinsics, nb::handle rays, nb::handle depth_scale,
                     nb::handle camera_pose, nb::handle clouds, nb::handle out, nb::handle capacity, nb::handle stream,
                     nb::handle other, bool ignore_limits, bool rest) {
    if (device == on_the_host)
      throw std::invalid_argument("clearance: enqueue is for a query on a CUDA device, and this one asks on the cpu");
    const asked_frame frame = frame_of(points, joints, poses, base, cloud_pose, depth, intrinsics, rays, depth_scale,
                                       camera_pose, clouds, {ignore_limits, rest}, true);
    std::optional<std::size_t> pairs;
    if (!capacity.is_none()) pairs = count_of(capacity, "capacity");
    return query->enqueue(frame.places, frame.seen, other, *stream_of(stream, true), out, pairs, frame.kept);
  }

  /// The protocols' numbers, or an object of torch or CuPy. Without one, arrays on a device were handed over in order
  /// of the legacy default stream, as DLPack has it.
  std::optional<void*> stream_of(nb::handle stream, bool on_device) const {
    if (stream.is_none()) return on_device ? std::optional<void*>(nullptr) : std::nullopt;
    if (device == on_the_host) throw std::invalid_argument("clearance: stream is for a query on a CUDA device");
    nb::object number = nb::borrow(stream);
    std::intptr_t value = 0;
    for (const char* name : {"cuda_stream", "ptr"})
      if (nb::hasattr(stream, name)) number = stream.attr(name);
    if (!nb::try_cast(number, value))
      throw nb::type_error("stream is an integer (-1, 1, 2 or a pointer), or a stream of torch or CuPy");
    if (value < -1) throw std::invalid_argument("clearance: stream is " + std::to_string(value) + ", which is none");
    return reinterpret_cast<void*>(value);
  }
};

}  // namespace

void bind_query(nb::module_& m) {
  nb::class_<query_object>(m, "Query",
                           "A question prepared for a robot on one device: make it once and ask it in every frame. Any "
                           "number of threads may "
                           "call it.")
      .def(nb::init<std::shared_ptr<robot_model>, nb::object, const std::string&>(), nb::arg("robot"),
           nb::arg("question").none(), nb::arg("device") = "cpu",
           "question: such as MinDistance(). device: \"cpu\", or \"cuda:0\" and so on.")
      .def("__call__", &query_object::operator(), nb::arg("points").none() = nb::none(),
           nb::arg("joints").none() = nb::none(), nb::kw_only(), nb::arg("poses").none() = nb::none(),
           nb::arg("base").none() = nb::none(), nb::arg("cloud_pose").none() = nb::none(),
           nb::arg("depth").none() = nb::none(), nb::arg("intrinsics").none() = nb::none(),
           nb::arg("rays").none() = nb::none(), nb::arg("depth_scale").none() = nb::none(),
           nb::arg("camera_pose").none() = nb::none(), nb::arg("clouds").none() = nb::none(),
           nb::arg("stream").none() = nb::none(), nb::arg("question").none() = nb::none(),
           nb::arg("ignore_limits") = false, nb::arg("rest") = false,
           "Asks about one frame and waits for the answer. Where the robot is: joints (joints,) or {name: value}, with "
           "base (world-from-base); or poses (parts, 4, 4), world-from-part; rest: what nothing is said of is at rest, "
           "or "
           "at the base. Questions about many configurations take "
           "joints (..., joints) or poses (..., parts, 4, 4). What is seen: points with cloud_pose; depth with "
           "intrinsics or rays and camera_pose; or clouds, a sequence of points(...) and depth_image(...). question: "
           "other options for this call. Raises ValueError with a sentence that names the argument.")
      .def("enqueue", &query_object::enqueue, nb::arg("points").none() = nb::none(),
           nb::arg("joints").none() = nb::none(), nb::kw_only(), nb::arg("poses").none() = nb::none(),
           nb::arg("base").none() = nb::none(), nb::arg("cloud_pose").none() = nb::none(),
           nb::arg("depth").none() = nb::none(), nb::arg("intrinsics").none() = nb::none(),
           nb::arg("rays").none() = nb::none(), nb::arg("depth_scale").none() = nb::none(),
           nb::arg("camera_pose").none() = nb::none(), nb::arg("clouds").none() = nb::none(),
           nb::arg("out").none() = nb::none(), nb::arg("capacity").none() = nb::none(),
           nb::arg("stream").none() = nb::none(), nb::arg("question").none() = nb::none(),
           nb::arg("ignore_limits") = false, nb::arg("rest") = false,
           "Asks on a device, without waiting: clouds are arrays there, and so is the answer, which work in stream "
           "waits for. stream: an integer (-1: you see to the order; 1, 2, or a pointer), or one of torch or CuPy; "
           "None: "
           "the legacy default one. out: arrays to write, by name, such as the last answer. capacity: of pairs. Raises "
           "ValueError as a call.")
      .def_prop_ro("question", [](const query_object& q) { return q.question; })
      .def_prop_ro("robot", [](const query_object& q) { return q.robot; })
      .def_prop_ro("device", [](const query_object& q) { return device_name(q.device); });
  bind_device_array(m);
  bind_enqueued(m);
}
