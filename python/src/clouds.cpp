// SPDX-License-Identifier: BSD-3-Clause
#include "clouds.hpp"

#include "arrays.hpp"
#include "device_array.hpp"
#include "questions.hpp"
#include "robot.hpp"
#include "seen_array.hpp"

#include <clearance/frames/frame.hpp>

#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include <algorithm>

using namespace clearance;

namespace {

/// A step that fits into the library's views.
std::uint32_t step_of(std::int64_t bytes, const char* argument) {
  if (bytes < 0 || bytes > UINT32_MAX)
    throw std::invalid_argument(std::string("clearance: ") + argument +
                                " runs backwards or too far apart in memory; copy it first (numpy.ascontiguousarray)");
  return std::uint32_t(bytes);
}

/// Points as records: the axes before the last one are rows, and records in a row.
template <class Scalar>
strided_points<Scalar> records(const seen_array& seen, std::size_t axes, std::array<std::int64_t, 3> offsets) {
  strided_points<Scalar> made;
  made.data = seen.data;
  made.count = 1;
  for (std::size_t k = 0; k < axes; ++k) made.count *= seen.shape[k];
  for (int k = 0; k < 3; ++k) made.offset[k] = step_of(offsets[std::size_t(k)], "points");
  if (axes == 0) return made;
  made.step = step_of(seen.strides[axes - 1], "points");
  if (axes == 2 && seen.strides[0] != seen.strides[1] * std::int64_t(seen.shape[1])) {
    made.width = std::uint32_t(seen.shape[1]);
    if (seen.strides[0] < 0) step_of(-1, "points");
    made.row_step = std::size_t(seen.strides[0]);
  }
  return made;
}

constexpr const char* points_wanted =
    "an array of shape (n, 3) or (rows, columns, 3) and dtype float32 or float64, or a structured one with x, y and z";

/// A structured array, such as a PointCloud2's records.
std::optional<seen_array> structured(nb::handle given, std::array<std::int64_t, 3>& offsets) {
  if (!nb::hasattr(given, "dtype") || !nb::hasattr(given, "__array_interface__")) return {};
  const nb::object fields = given.attr("dtype").attr("fields");
  if (fields.is_none()) return {};
  const nb::object names = given.attr("dtype").attr("names");
  std::string type;
  int k = 0;
  for (const char* axis : {"x", "y", "z"}) {
    if (!nb::cast<bool>(fields.attr("__contains__")(axis)))
      throw std::invalid_argument(std::string("clearance: points has no field ") + axis + ", only " + text_of(names));
    const nb::object field = fields[axis];
    const auto its = nb::cast<std::string>(nb::object(field[nb::int_(0)]).attr("str"));
    if (!type.empty() && its != type)
      throw std::invalid_argument("clearance: the fields x, y and z of points have different types");
    type = its;
    offsets[std::size_t(k++)] = nb::cast<std::int64_t>(field[nb::int_(1)]);
  }
  nb::dict interface = given.attr("__array_interface__");
  seen_array seen = from_interface(given, interface, on_the_host, "points");
  if (type[0] == '>')
    throw std::invalid_argument("clearance: points has the byte order of another machine; byteswap it first: " +
                                shape_and_type(given));
  seen.kind = type[1], seen.item = std::size_t(std::stoul(type.substr(2)));
  return seen;
}

template <class Scalar>
void place(cloud_object& made, strided_points<Scalar> records, const point_filter& filter,
           const Eigen::Isometry3d& pose) {
  records.filter = filter;
  if constexpr (std::is_same_v<Scalar, float>) {
    const bool dense = records.width == 0 && records.step == sizeof(vec3) && records.offset[0] == 0 &&
                       records.offset[1] == 4 && records.offset[2] == 8 &&
                       reinterpret_cast<std::uintptr_t>(records.data) % alignof(vec3) == 0;
    if (dense) {
      made.cloud =
          placed<point_span>{point_span(reinterpret_cast<const vec3*>(records.data), records.count, filter), pose};
      return;
    }
  }
  made.far = std::is_same_v<Scalar, double>;
  made.cloud = placed<strided_points<Scalar>>{records, pose};
}

intrinsics camera_of(nb::handle given) {
  std::vector<double> k;
  try {
    const nb::object flat = nb::module_::import_("numpy").attr("ascontiguousarray")(given, "f8");
    const auto array = nb::cast<nb::ndarray<const double, nb::c_contig>>(flat);
    if (array.size() == 4 && array.ndim() == 1) k.assign(array.data(), array.data() + 4);
    if (array.ndim() == 2 && array.shape(0) == 3 && array.shape(1) == 3) {
      const double* const m = array.data();
      if (m[1] != 0 || m[3] != 0 || m[6] != 0 || m[7] != 0 || m[8] != 1)
        throw std::invalid_argument(
            "clearance: intrinsics is a matrix with skew, or with a last row other than 0, 0, 1");
      k = {m[0], m[4], m[2], m[5]};
    }
  } catch (nb::python_error&) {
  } catch (const nb::cast_error&) {
  }
  if (k.empty())
    throw std::invalid_argument(
        "clearance: intrinsics is (fx, fy, cx, cy) in pixels, or the matrix K of shape (3, 3), not " +
        shape_and_type(given));
  for (const double v : k)
    if (!std::isfinite(v)) throw std::invalid_argument("clearance: intrinsics has a number that is not finite");
  if (!(k[0] > 0 && k[1] > 0))
    throw std::invalid_argument("clearance: intrinsics has a focal length that is not above 0");
  return {k[0], k[1], k[2], k[3]};
}

/// Do a table's rays, which are pairs of floats, follow one another?
bool without_gaps(const seen_array& table) {
  return table.strides[2] == 4 && table.strides[1] == 8 && table.strides[0] == 8 * std::int64_t(table.shape[1]);
}

template <class Image>
void limit(Image& image, double nearest, double farthest, bool minus_infinity_is_near) {
  image.nearest = real(nearest), image.farthest = real(farthest), image.minus_infinity_is_near = minus_infinity_is_near;
}

}  // namespace

namespace {

/// The cloud with floats relative to a place near the robot.
whole_cloud relative_to(const cloud_object& object, const Eigen::Vector3d& robot) {
  if (!object.far) return object.cloud;
  auto cloud = std::get<placed<strided_points<double>>>(object.cloud);
  // Coarse, and of what stays where joints move: so each of many configurations has the answer that it has alone.
  constexpr double grid = 16;
  const Eigen::Vector3d origin = ((cloud.pose.inverse() * robot) / grid).array().round() * grid;
  if (!(origin.cwiseAbs().maxCoeff() > 32) || !(origin.cwiseAbs().maxCoeff() < 1 << 24)) return cloud;
  cloud.source.origin = {real(origin.x()), real(origin.y()), real(origin.z())};
  const Eigen::Vector3d sensor = object.sensor - origin;
  cloud.source.filter.sensor = {real(sensor.x()), real(sensor.y()), real(sensor.z())};
  cloud.source.off = frames::pose_error * (cloud.pose.translation().norm() + origin.norm());
  cloud.pose.translation() = cloud.pose * origin;
  return cloud;
}

}  // namespace

any_cloud near_robot(const cloud_object& object, const Eigen::Vector3d& robot) {
  return std::visit(
      [&](const auto& whole) -> any_cloud {
        return placed{cropped(whole.source, object.where.seen_from(whole.pose)), whole.pose};
      },
      relative_to(object, robot));
}

cloud_object cloud_of_points(nb::handle points, nb::handle pose, double nearest, double farthest, nb::handle sensor,
                             bool zero_is_missing) {
  cloud_object made;
  std::array<std::int64_t, 3> offsets{};
  std::size_t axes = 0;
  seen_array seen;
  if (auto record = structured(points, offsets)) {
    seen = std::move(*record);
    axes = seen.shape.size();
    if (axes == 0)
      throw std::invalid_argument(std::string("clearance: points is ") + points_wanted + ", not one record");
  } else {
    seen = array_seen(points, "points", points_wanted);
    if (nb::hasattr(points, "mask") && nb::hasattr(points, "filled"))
      throw std::invalid_argument(
          "clearance: points is a masked array; give points.filled(nan), whose NaN are counted");
    if (seen.shape.size() > 1 && seen.shape.back() > 3)
      throw std::invalid_argument(std::string("clearance: points is ") + points_wanted + ", not " +
                                  shape_and_type(points) + "; points[..., :3] is read in place, too");
    if (seen.shape.size() < 2 || seen.shape.back() != 3)
      throw std::invalid_argument(std::string("clearance: points is ") + points_wanted + ", not " +
                                  shape_and_type(points));
    axes = seen.shape.size() - 1;
    for (std::size_t k = 0; k < 3; ++k) offsets[k] = std::int64_t(k) * seen.strides.back();
  }
  if (axes > 2 || seen.kind != 'f' || (seen.item != 4 && seen.item != 8))
    throw std::invalid_argument(std::string("clearance: points is ") + points_wanted + ", not " +
                                shape_and_type(points));
  // Of an array that was broadcast one record stands for many; sources have records that lie apart.
  const bool any_points = std::find(seen.shape.begin(), seen.shape.end(), std::size_t(0)) == seen.shape.end();
  for (std::size_t k = 0; any_points && k < axes; ++k)
    if (seen.strides[k] == 0 && seen.shape[k] > 1) {
      const nb::object copy = seen.device == on_the_host
                                  ? nb::object(nb::module_::import_("numpy").attr("ascontiguousarray")(points))
                                  : points.attr(nb::hasattr(points, "contiguous") ? "contiguous" : "copy")();
      return cloud_of_points(copy, pose, nearest, farthest, sensor, zero_is_missing);
    }
  if (!(nearest >= 0) || !(farthest >= nearest))
    throw std::invalid_argument("clearance: nearest is 0 or more, and farthest not less; here are " +
                                std::to_string(nearest) + " and " + std::to_string(farthest));
  point_filter filter{.nearest = real(nearest), .farthest = real(farthest), .zero_is_missing = zero_is_missing};
  if (!sensor.is_none()) {
    const auto at = three_of(sensor, "sensor");
    made.sensor = {at[0], at[1], at[2]};
    filter.sensor = {real(at[0]), real(at[1]), real(at[2])};
  }
  const Eigen::Isometry3d where = pose_of(pose, "pose");
  if (seen.item == 4)
    place(made, records<float>(seen, axes, offsets), filter, where);
  else
    place(made, records<double>(seen, axes, offsets), filter, where);
  made.device = seen.device, made.kept = std::move(seen.kept), made.also_kept = nb::borrow(points);
  return made;
}

cloud_object depth_of(nb::handle depth, nb::handle intrinsics, nb::handle pose, nb::handle scale, double nearest,
                      double farthest, bool minus_infinity_is_near, nb::handle rays) {
  constexpr const char* wanted = "an image of shape (rows, columns) and dtype uint16 or float32";
  const seen_array seen = array_seen(depth, "depth", wanted);
  const bool integers = seen.kind == 'u' && seen.item == 2, floats = seen.kind == 'f' && seen.item == 4;
  if (seen.shape.size() != 2 || !(integers || floats))
    throw std::invalid_argument(std::string("clearance: depth is ") + wanted + ", not " + shape_and_type(depth));
  if (intrinsics.is_none() == rays.is_none())
    throw std::invalid_argument("clearance: a depth image needs intrinsics, or rays, one of them");
  if (!(farthest >= nearest)) throw std::invalid_argument("clearance: farthest is less than nearest");
  const bool empty = seen.shape[0] == 0 || seen.shape[1] == 0;  // whose steps mean nothing
  if (!empty && seen.strides[0] % std::int64_t(seen.item) != 0)
    throw std::invalid_argument("clearance: depth has rows that begin in the middle of a pixel; copy it first");
  if (nb::hasattr(depth, "mask") && nb::hasattr(depth, "filled"))
    throw std::invalid_argument("clearance: depth is a masked array; give depth.filled(0), which counts as missing");
  if (!empty && seen.shape[1] > 1 && seen.strides[1] != std::int64_t(seen.item))
    throw std::invalid_argument("clearance: depth has pixels that do not follow one another in a row; copy it first");
  const double unit = scale.is_none() ? (integers ? 0.001 : 1.0) : number_of(scale, "scale");
  if (!(unit > 0 && std::isfinite(unit))) throw std::invalid_argument("clearance: scale is metres per unit, above 0");
  const auto height = std::uint32_t(seen.shape[0]), width = std::uint32_t(seen.shape[1]);
  const auto row =
      std::uint32_t(step_of(height > 1 && !empty ? seen.strides[0] : width * seen.item, "depth") / seen.item);
  cloud_object made;
  const Eigen::Isometry3d where = pose_of(pose, "pose");
  const auto put = [&]<class Pixel>(const Pixel* pixels) {
    if (rays.is_none()) {
      depth_image<Pixel> image(pixels, width, height, camera_of(intrinsics), unit);
      image.row = row;
      limit(image, nearest, farthest, minus_infinity_is_near);
      made.cloud = placed<depth_image<Pixel>>{image, where};
      return;
    }
    const seen_array table = array_seen(rays, "rays", "an array of shape (rows, columns, 2) and dtype float32");
    if (table.shape.size() != 3 || table.shape[0] != height || table.shape[1] != width || table.shape[2] != 2 ||
        table.kind != 'f' || table.item != 4 || !(empty || without_gaps(table)) || table.device != seen.device)
      throw std::invalid_argument(
          "clearance: rays is an array of shape (" + std::to_string(height) + ", " + std::to_string(width) +
          ", 2) and dtype float32, without gaps and beside the image, not " + shape_and_type(rays));
    ray_image<Pixel> image(pixels, reinterpret_cast<const ray*>(table.data), width, height, unit);
    image.row = row;
    limit(image, nearest, farthest, minus_infinity_is_near);
    made.cloud = placed<ray_image<Pixel>>{image, where};
    made.also_kept = nb::make_tuple(table.kept, nb::borrow(rays));
  };
  if (integers)
    put(reinterpret_cast<const std::uint16_t*>(seen.data));
  else
    put(reinterpret_cast<const float*>(seen.data));
  made.device = seen.device;
  made.kept = nb::make_tuple(seen.kept, nb::borrow(depth));
  return made;
}

namespace {

/// So many numbers, in whatever shape.
std::vector<double> numbers_of(nb::handle given, std::size_t count, const char* wanted) {
  std::vector<double> made;
  try {
    const nb::object flat = nb::module_::import_("numpy").attr("ascontiguousarray")(given, "f8").attr("ravel")();
    const auto array = nb::cast<nb::ndarray<const double, nb::c_contig>>(flat);
    made.assign(array.data(), array.data() + array.size());
  } catch (nb::python_error&) {
  } catch (const nb::cast_error&) {
  }
  if (made.size() != count)
    throw std::invalid_argument("clearance: " + std::string(wanted) + ", not " + shape_and_type(given));
  return made;
}

}  // namespace

cloud_object cropped_of(nb::handle cloud, nb::handle inside, nb::handle outside, nb::handle pose, nb::handle height,
                        nb::handle plane) {
  cloud_object* whole = nullptr;
  if (!nb::try_cast(cloud, whole) || !whole)
    throw nb::type_error("cropped: cloud is what points(...) or depth_image(...) returns");
  if (inside.is_none() && outside.is_none() && height.is_none() && plane.is_none())
    throw std::invalid_argument("clearance: cropped needs inside, outside, height or plane");
  if (inside.is_none() && outside.is_none() && !pose.is_none())
    throw std::invalid_argument("clearance: pose is that of the box of inside or outside, and neither is given");
  cloud_object made = *whole;
  const Eigen::Isometry3d world_from_box = pose_of(pose, "pose");
  const auto box = [&](nb::handle given, const char* wanted, auto add) {
    if (given.is_none()) return;
    const auto v = numbers_of(given, 6, wanted);
    (made.where.*add)({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, world_from_box);
  };
  box(inside, "inside is the lower and the upper corner of a box, an array of shape (2, 3)", &crop::inside);
  box(outside, "outside is the lower and the upper corner of a box, an array of shape (2, 3)", &crop::outside);
  if (!height.is_none()) {
    const auto v = numbers_of(height, 2, "height is (low, high), metres");
    made.where.height(v[0], v[1]);
  }
  if (!plane.is_none()) {
    const auto v = numbers_of(plane, 5, "plane is (a, b, c, d, thickness), of ax + by + cz = d");
    made.where.without_plane({v[0], v[1], v[2]}, v[3], v[4]);
  }
  return made;
}

namespace {

/// Do values follow one another? `count`: how many there are.
bool is_dense(const seen_array& seen, std::size_t& count) {
  bool dense = true;
  for (std::size_t k = seen.shape.size(); k-- > 0; count *= seen.shape[k])
    dense &= seen.shape[k] < 2 || seen.strides[k] == std::int64_t(count * seen.item);
  return dense;
}

/// A radius for each point, where they lie.
point_radii radii_of(nb::handle given, cloud_doubts& doubts) {
  constexpr const char* wanted =
      "None, KinectNoise(...), StereoNoise(...), TofNoise(...), LidarNoise(...), or an array of radii, one a point, of "
      "dtype float32";
  seen_array seen = array_seen(given, "noise", wanted);
  std::size_t count = 1;
  const bool dense = is_dense(seen, count);
  if (seen.shape.empty() || seen.kind != 'f' || seen.item != sizeof(real))
    throw std::invalid_argument(std::string("clearance: noise is ") + wanted + ", not " + shape_and_type(given));
  if (!dense) throw std::invalid_argument("clearance: noise has gaps between its radii; copy it first");
  doubts.device = seen.device;
  doubts.kept = nb::make_tuple(std::move(seen.kept), nb::borrow(given));
  const auto* const radii = reinterpret_cast<const real*>(seen.data);
  return seen.device == on_the_host ? point_radii(std::span(radii, count)) : point_radii(radii, count);
}

}  // namespace

cloud_object uncertain_of(nb::handle cloud, nb::handle noise, double shift, double turn, double max_speed, double age) {
  cloud_object* bare = nullptr;
  if (!nb::try_cast(cloud, bare) || !bare)
    throw nb::type_error("uncertain: cloud is what points(...) or depth_image(...) returns");
  if (bare->doubts) throw std::invalid_argument("clearance: cloud is uncertain already");
  cloud_object made = *bare;
  made.recipe = nb::object();
  cloud_doubts& doubts = made.doubts.emplace();
  doubts.of = {shift, turn, max_speed, age};
  any_noise& its = doubts.noise;
  const auto is = [&]<class N>(noise_kind kind, N& of_kind) {
    if (!nb::isinstance<asked<N>>(noise)) return false;
    its.kind = kind, of_kind = nb::cast<const asked<N>&>(noise).question;
    return true;
  };
  if (!noise.is_none() && !is(noise_kind::kinect, its.kinect) && !is(noise_kind::stereo, its.stereo) &&
      !is(noise_kind::tof, its.tof) && !is(noise_kind::lidar, its.lidar))
    its.kind = noise_kind::radii, its.radii = radii_of(noise, doubts);
  std::visit([&](const auto& placed) { uncertain(placed.source, its, doubts.of); }, made.cloud);  // throws
  if (its.kind != noise_kind::none && its.kind != noise_kind::radii && its(0, {0, 0, 1}) == 0)
    throw std::invalid_argument("clearance: noise is " + nb::cast<std::string>(nb::repr(noise)) +
                                ", which is 0 a metre away; None says that there is none");
  return made;
}

cloud_object masked_of(nb::handle cloud, nb::handle labels) {
  cloud_object* bare = nullptr;
  if (!nb::try_cast(cloud, bare) || !bare)
    throw nb::type_error("masked: cloud is what points(...), depth_image(...) or uncertain(...) returns");
  if (bare->labels) throw std::invalid_argument("clearance: cloud is masked already; join the labels first");
  constexpr const char* wanted = "an array of one label a point, uint8 (PointLabel) or bool (True: hidden)";
  const seen_array seen = array_seen(labels, "labels", wanted);
  std::size_t count = 1;
  const bool dense = is_dense(seen, count);
  const std::size_t points = std::visit([](const auto& placed) { return placed.source.size(); }, bare->cloud);
  if (seen.shape.empty() || !(seen.kind == 'u' || seen.kind == 'b') || seen.item != 1 || count != points)
    throw std::invalid_argument(std::string("clearance: labels is ") + wanted + ", and there are " +
                                std::to_string(points) + " points; not " + shape_and_type(labels));
  if (seen.device != on_the_host)
    throw std::invalid_argument("clearance: labels lie on " + device_name(seen.device) +
                                ", and only queries on the cpu take masked clouds");
  if (count != 0 && !dense) throw std::invalid_argument("clearance: labels has gaps between its values; copy it first");
  static const point_label nothing{};  // an empty array may have no address
  cloud_object made = *bare;
  made.labels = count == 0 ? &nothing : reinterpret_cast<const point_label*>(seen.data);
  made.also_kept = nb::make_tuple(made.also_kept ? made.also_kept : nb::none(), seen.kept, nb::borrow(labels));
  made.recipe = nb::object();
  return made;
}

/// The cloud that Python holds: with what made it, for pickle.
cloud_object made_by(const char* maker, nb::tuple arguments, nb::dict named, cloud_object cloud) {
  cloud.recipe = nb::make_tuple(maker, std::move(arguments), std::move(named));
  return cloud;
}

/// Of (rows, columns, 2) float32 in host memory.
double half_pixel(nb::handle rays) {
  const seen_array table = array_seen(rays, "rays", "an array of shape (rows, columns, 2) and dtype float32");
  if (table.shape.size() != 3 || table.shape[2] != 2 || table.kind != 'f' || table.item != 4 || !without_gaps(table) ||
      table.device != on_the_host)
    throw std::invalid_argument(
        "clearance: rays is an array on the cpu of shape (rows, columns, 2) and dtype float32, without gaps, not " +
        shape_and_type(rays));
  return half_pixel_of(reinterpret_cast<const ray*>(table.data), table.shape[1], table.shape[0]);
}

void bind_clouds(nb::module_& m) {
  nb::class_<cloud_object>(m, "Cloud", "Points or a depth image with a pose: a view of arrays where they lie.")
      .def("__len__",
           [](const cloud_object& c) {
             return std::visit([](const auto& placed) { return placed.source.size(); }, c.cloud);
           })
      .def_prop_ro(
          "device", [](const cloud_object& c) { return device_name(c.device); },
          "Where its array lies: \"cpu\", or \"cuda:0\" and so on.")
      .def("__reduce__",
           [](const cloud_object& c) {
             return nb::make_tuple(nb::module_::import_("clearance._made").attr("cloud"), c.recipe);
           })
      .def("__repr__", [](const cloud_object& c) {
        const auto count = std::visit([](const auto& placed) { return placed.source.size(); }, c.cloud);
        return "<Cloud of " + std::to_string(count) + " points on " + device_name(c.device) +
               (c.doubts ? ", uncertain" : "") + (c.labels ? ", masked>" : ">");
      });
  m.def(
      "points",
      [](nb::handle points, nb::handle pose, double nearest, double farthest, nb::handle sensor, bool zero_is_missing) {
        nb::dict named;
        named["nearest"] = nearest;
        named["farthest"] = farthest;
        named["sensor"] = sensor;
        named["zero_is_missing"] = zero_is_missing;
        return made_by("points", nb::make_tuple(points, pose), named,
                       cloud_of_points(points, pose, nearest, farthest, sensor, zero_is_missing));
      },
      nb::arg("points"), nb::arg("pose").none() = nb::none(), nb::kw_only(), nb::arg("nearest") = 0.0,
      nb::arg("farthest") = double(infinity), nb::arg("sensor").none() = nb::none(), nb::arg("zero_is_missing") = false,
      "A cloud of points, (n, 3) or (rows, columns, 3), float32 or float64, or structured with x, y, z; metres; read "
      "in place. pose: world-from-cloud, (4, 4). Points nearer to the sensor than nearest, or beyond farthest, do not "
      "count. zero_is_missing: a point at the sensor is none.");
  m.def(
      "depth_image",
      [](nb::handle depth, nb::handle intrinsics, nb::handle pose, nb::handle scale, double nearest, double farthest,
         bool minus_infinity_is_near, nb::handle rays) {
        nb::dict named;
        named["scale"] = scale;
        named["nearest"] = nearest;
        named["farthest"] = farthest;
        named["minus_infinity_is_near"] = minus_infinity_is_near;
        named["rays"] = rays;
        return made_by("depth_image", nb::make_tuple(depth, intrinsics, pose), named,
                       depth_of(depth, intrinsics, pose, scale, nearest, farthest, minus_infinity_is_near, rays));
      },
      nb::arg("depth"), nb::arg("intrinsics").none() = nb::none(), nb::arg("pose").none() = nb::none(), nb::kw_only(),
      nb::arg("scale").none() = nb::none(), nb::arg("nearest") = 0.0, nb::arg("farthest") = double(infinity),
      nb::arg("minus_infinity_is_near") = true, nb::arg("rays").none() = nb::none(),
      "A depth image, (rows, columns): uint16 times scale (0.001 m unless given; 0 is missing, 65535 saturated), or "
      "float32 metres (REP 117, 118). intrinsics: (fx, fy, cx, cy) in pixels or K (3, 3); or rays, (rows, columns, 2): "
      "x / z and y / z of each pixel. pose: world-from-camera, z forward.");
  m.def(
      "cropped",
      [](nb::handle cloud, nb::handle inside, nb::handle outside, nb::handle pose, nb::handle height,
         nb::handle plane) {
        nb::dict named;
        named["inside"] = inside;
        named["outside"] = outside;
        named["pose"] = pose;
        named["height"] = height;
        named["plane"] = plane;
        return made_by("cropped", nb::make_tuple(cloud), named,
                       cropped_of(cloud, inside, outside, pose, height, plane));
      },
      nb::arg("cloud"), nb::kw_only(), nb::arg("inside").none() = nb::none(), nb::arg("outside").none() = nb::none(),
      nb::arg("pose").none() = nb::none(), nb::arg("height").none() = nb::none(), nb::arg("plane").none() = nb::none(),
      "The same cloud without points that are no obstacles by their place in the world, which are counted as cropped. "
      "Obstacles are inside a box (2, 3), lower and upper corner, and outside another (pose: world-from-box, of both); "
      "at a height (low, high); and farther than thickness from plane, (a, b, c, d, thickness), of ax + by + cz = d. "
      "Metres. A cloud may be cropped again, by four of these in all.");
  m.def(
      "uncertain",
      [](nb::handle cloud, nb::handle noise, double shift, double turn, double max_speed, double age) {
        nb::dict named;
        named["shift"] = shift;
        named["turn"] = turn;
        named["max_speed"] = max_speed;
        named["age"] = age;
        return made_by("uncertain", nb::make_tuple(cloud, noise), named,
                       uncertain_of(cloud, noise, shift, turn, max_speed, age));
      },
      nb::arg("cloud"), nb::arg("noise").none() = nb::none(), nb::kw_only(), nb::arg("shift") = 0.0,
      nb::arg("turn") = 0.0, nb::arg("max_speed") = 0.0, nb::arg("age") = 0.0,
      "The same cloud, whose points may be elsewhere: for CertainDistance and others. noise: KinectNoise(), "
      "StereoNoise(...), TofNoise(...), LidarNoise(...), or an array of radii (m), one a point, float32, where the "
      "query asks. shift, turn: of the sensor's pose (m, rad). max_speed, age: of obstacles (m/s), of the cloud (s).");
  m.def(
      "masked",
      [](nb::handle cloud, nb::handle labels) {
        return made_by("masked", nb::make_tuple(cloud, labels), nb::dict(), masked_of(cloud, labels));
      },
      nb::arg("cloud"), nb::arg("labels"),
      "The same cloud without some of its points, which are dropped as masked; the others keep their numbers. labels: "
      "one a point, read in place: uint8 as SelfFilter's labels (PointLabel.own is hidden), or bool (True is hidden). "
      "For queries on the cpu; Unseen has labels of its own.");
  m.def("half_pixel_of", &half_pixel, nb::arg("rays"),
        "Half the diagonal of the widest pixel at z = 1, of a table of rays (rows, columns, 2), float32: for Unseen.");
}
