// SPDX-License-Identifier: BSD-3-Clause
#include "query.hpp"

#include "arrays.hpp"
#include "prepared_query.hpp"

#include <clearance/io/joint_motion.hpp>

#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

using namespace clearance;
using namespace clearance::python;

void refuse_option(const char* question, const char* option, const char* wanted, nb::handle given) {
  const nb::object one_line = nb::str(" ").attr("join")(nb::repr(given).attr("split")());  // arrays have several
  throw nb::type_error(
      (std::string(question) + ": " + option + " is " + wanted + ", not " + nb::cast<std::string>(one_line)).c_str());
}

namespace {

/// How many threads a host may use. Throws std::invalid_argument.
unsigned threads_of(nb::handle given, int device) {
  if (given.is_none()) return 0;
  const std::size_t threads = count_of(given, "threads");
  if (device != on_the_host)
    throw std::invalid_argument("clearance: threads are of the cpu, and this query asks on " + device_name(device));
  if (threads == 0 || threads > 4096)
    throw std::invalid_argument("clearance: threads is " + std::to_string(threads) +
                                "; it is from 1 to 4096, or None for all");
  return unsigned(threads);
}

struct query_object {
  std::shared_ptr<robot_model> robot;
  nb::object question, kept;
  int device;
  unsigned threads;  ///< 0: all.
  std::unique_ptr<any_query> query;

  query_object(std::shared_ptr<robot_model> robot_, nb::object question_, const std::string& device_,
               nb::handle threads_)
      : robot(std::move(robot_)),
        question(std::move(question_)),
        device(device_number(device_)),
        threads(threads_of(threads_, device)) {
    if (PyType_Check(question.ptr())) question = question();  // MinDistance for MinDistance()
    for_each_declared([&]<class T>() {
      if constexpr (declared<T>::question)
        if (nb::isinstance<asked<T>>(question))
          query = std::make_unique<query_of<T>>(robot, nb::cast<const asked<T>&>(question).question, device, threads);
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
    auto [at, shape] = robot_placed(*robot, joints, poses, base, how);
    places = std::move(at);
    made.shape = std::move(shape);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    if (!poses.is_none()) {
      if (!places.empty()) middle = places[0].translation();
    } else {
      middle = pose_of(base, "base").translation();
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
      made.seen.push_back({near_robot(cloud, middle), cloud.doubts, cloud.labels});
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
    return query->ask(frame, other, stream_of(stream, frame.on_device));
  }

  nb::object worlds(nb::handle clouds, nb::handle joints, nb::handle splits, nb::handle poses, nb::handle base,
                    nb::handle stream, nb::handle other, bool ignore_limits, bool rest) {
    nb::list each;
    if (splits.is_none()) {
      if (nb::hasattr(clouds, "dtype") || !nb::hasattr(clouds, "__iter__"))
        throw std::invalid_argument(
            "clearance: clouds is a sequence, one for each world; or one array of all points, and splits says where "
            "each world's begin");
      for (const nb::handle one : clouds) each.append(one);
    } else {
      std::vector<std::size_t> rows;
      if (!nb::try_cast(nb::module_::import_("numpy").attr("asarray")(splits).attr("tolist")(), rows) || rows.empty() ||
          rows.front() != 0 || rows.back() != nb::len(clouds) || !std::ranges::is_sorted(rows))
        throw std::invalid_argument(
            "clearance: splits is (worlds + 1) row numbers that begin with 0, never fall, and end with the number of "
            "points");
      for (std::size_t w = 0; w + 1 < rows.size(); ++w)
        each.append(clouds[nb::slice(nb::int_(rows[w]), nb::int_(rows[w + 1]), nb::none())]);
    }
    const std::size_t count = nb::len(each);
    const auto its = [&](nb::handle given, const char* name, int shared) {
      const bool all = given.is_none() || nb::isinstance<nb::dict>(given) ||
                       (shared != 0 && nb::cast<int>(nb::module_::import_("numpy").attr("ndim")(given)) == shared);
      if (!all && nb::len(given) != count)
        throw std::invalid_argument("clearance: there are " + std::to_string(count) + " worlds, and " + name +
                                    " is for " + std::to_string(nb::len(given)));
      return [=](std::size_t w) { return all ? nb::borrow(given) : nb::object(given[nb::int_(w)]); };
    };
    const auto joints_in = its(joints, "joints", 0), poses_in = its(poses, "poses", 0), base_in = its(base, "base", 2);
    const nb::object no = nb::none();
    std::vector<asked_frame> frames;
    bool on_device = false;
    for (std::size_t w = 0; w < count; ++w) {
      nb::list seen;
      seen.append(each[w]);
      frames.push_back(frame_of(no, joints_in(w), poses_in(w), base_in(w), no, no, no, no, no, no, seen,
                                {ignore_limits, rest}, false));
      on_device |= frames.back().on_device;
    }
    return query->worlds(frames, other, stream_of(stream, on_device));
  }

  nb::object over_motion(nb::handle start, nb::handle end, nb::handle points, nb::handle base, nb::handle cloud_pose,
                         nb::handle depth, nb::handle intrinsics, nb::handle rays, nb::handle depth_scale,
                         nb::handle camera_pose, nb::handle clouds, nb::handle stream, double tolerance, double margin,
                         nb::handle most_queries, nb::handle radii, bool ignore_limits) {
    auto* const its = dynamic_cast<query_of<min_distance_per_part>*>(query.get());
    if (!its)
      throw std::invalid_argument("clearance: a motion is asked by a query of MinDistancePerPart, and this one asks " +
                                  text_of(question.type().attr("__name__")));
    motion_clearance_options options{
        .tolerance = tolerance, .margin = margin, .most_queries = count_of(most_queries, "most_queries")};
    if (double one = 0; nb::try_cast(radii, one))
      options.radii = {one};
    else if (!radii.is_none() &&
             !nb::try_cast(nb::module_::import_("numpy").attr("asarray")(radii).attr("tolist")(), options.radii))
      throw std::invalid_argument("clearance: radii is a number of metres, or one for each part, not " +
                                  shape_and_type(radii));
    const bool by_poses = nb::hasattr(start, "ndim") && nb::cast<int>(start.attr("ndim")) == 3;
    const auto frame = [&](nb::handle joints, nb::handle poses) {
      return frame_of(points, joints, poses, by_poses ? nb::none() : nb::borrow(base), cloud_pose, depth, intrinsics,
                      rays, depth_scale, camera_pose, clouds, {ignore_limits, false}, false);
    };
    if (by_poses) {
      if (!base.is_none()) throw std::invalid_argument("clearance: poses are given, so base cannot be");
      const asked_frame from = frame(nb::none(), start);
      const straight_motion motion(from.places, poses_of(end, "end"));
      return answer(its->over(motion, from, options, stream_of(stream, from.on_device)));
    }
    const joint_reading how{ignore_limits, false};
    const joint_rows first = joints_given(*robot, start, how), last = joints_given(*robot, end, how);
    if (!first.shape.empty() || !last.shape.empty())
      throw std::invalid_argument("clearance: start and end are one configuration each");
    if (first.tree != last.tree && first.tree->size() != last.tree->size())
      throw std::invalid_argument("clearance: start and end name different joints that follow others");
    std::vector<std::size_t> links;
    for (const io::robot_part& part : robot->described().parts()) links.push_back(part.link);
    const io::joint_motion motion(*first.tree, std::move(links), first.values, last.values, {ignore_limits},
                                  pose_of(base, "base"));
    const asked_frame from = frame(start, nb::none());
    return answer(its->over(motion, from, options, stream_of(stream, from.on_device)));
  }

  nb::object answer(motion_clearance_result result) const {
    return nb::cast(answered<motion_clearance_result>{std::move(result), {robot->names, {}}});
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
      .def(nb::init<std::shared_ptr<robot_model>, nb::object, const std::string&, nb::handle>(), nb::arg("robot"),
           nb::arg("question").none(), nb::arg("device") = "cpu", nb::arg("threads").none() = nb::none(),
           "question: such as MinDistance(). device: \"cpu\", or \"cuda:0\" and so on. threads: how many work on the "
           "cpu; None: all.")
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
      .def(
          "worlds", &query_object::worlds, nb::arg("clouds"), nb::arg("joints").none() = nb::none(),
          nb::arg("splits").none() = nb::none(), nb::kw_only(), nb::arg("poses").none() = nb::none(),
          nb::arg("base").none() = nb::none(), nb::arg("stream").none() = nb::none(),
          nb::arg("question").none() = nb::none(), nb::arg("ignore_limits") = false, nb::arg("rest") = false,
          "Asks about many worlds, each with its own cloud, in one call: side by side on the cpu. clouds: one for each "
          "world; or one array (n, 3) of all points, of which world w has splits[w] to splits[w + 1] - 1. joints "
          "(worlds, ..., joints), poses (worlds, ..., parts, 4, 4), base (4, 4) or (worlds, 4, 4). Of MinDistance and "
          "MinDistances the answer is a MinDistancesResult of shape (worlds, ...), of InCollision and InCollisions an "
          "InCollisionsResult. Points have their numbers in their world.")
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
      .def_prop_ro(
          "question", [](const query_object& q) { return q.question; }, "With the options that a call may replace.")
      .def_prop_ro(
          "robot", [](const query_object& q) { return q.robot; }, "The robot that is asked about.")
      .def_prop_ro(
          "device", [](const query_object& q) { return device_name(q.device); },
          "Where it asks: \"cpu\", or \"cuda:0\" and so on.")
      .def_prop_ro(
          "threads",
          [](const query_object& q) { return q.threads == 0 ? nb::none() : nb::object(nb::int_(q.threads)); },
          nb::sig("def threads(self) -> int | None"), "How many threads work on the cpu; None: all.")
      .def("__reduce__",
           [](nb::handle self) {
             const auto& q = nb::cast<const query_object&>(self);
             return nb::make_tuple(self.type(),
                                   nb::make_tuple(q.robot, q.question, device_name(q.device), self.attr("threads")));
           })
      .def("__repr__", [](const query_object& q) {
        return "<Query of " + nb::cast<std::string>(nb::repr(q.question)) + " on " + device_name(q.device) + ">";
      });
  m.def(
      "motion_clearance",
      [](query_object& query, nb::handle start, nb::handle end, nb::handle points, nb::handle base,
         nb::handle cloud_pose, nb::handle depth, nb::handle intrinsics, nb::handle rays, nb::handle depth_scale,
         nb::handle camera_pose, nb::handle clouds, nb::handle stream, double tolerance, double margin,
         nb::handle most_queries, nb::handle radii, bool ignore_limits) {
        return query.over_motion(start, end, points, base, cloud_pose, depth, intrinsics, rays, depth_scale,
                                 camera_pose, clouds, stream, tolerance, margin, most_queries, radii, ignore_limits);
      },
      nb::arg("query"), nb::arg("start").none(), nb::arg("end").none(), nb::arg("points").none() = nb::none(),
      nb::kw_only(), nb::arg("base").none() = nb::none(), nb::arg("cloud_pose").none() = nb::none(),
      nb::arg("depth").none() = nb::none(), nb::arg("intrinsics").none() = nb::none(),
      nb::arg("rays").none() = nb::none(), nb::arg("depth_scale").none() = nb::none(),
      nb::arg("camera_pose").none() = nb::none(), nb::arg("clouds").none() = nb::none(),
      nb::arg("stream").none() = nb::none(), nb::arg("tolerance") = motion_clearance_options{}.tolerance,
      nb::arg("margin") = motion_clearance_options{}.margin,
      nb::arg("most_queries").none() = motion_clearance_options{}.most_queries, nb::arg("radii").none() = nb::none(),
      nb::arg("ignore_limits") = false,
      "How near points come over a whole motion, also between the times that are asked: never more than in truth. "
      "query: "
      "of MinDistancePerPart. start, end: joints, each of which moves at constant speed; or arrays of poses (parts, 4, "
      "4), between which parts go straight. tolerance: how far lower may be below the least at an asked time (m). "
      "margin: what state compares with (m). radii: by how much parts may be elsewhere (m). What is seen: as in a "
      "call.");
  bind_device_array(m);
  bind_enqueued(m);
}
