// SPDX-License-Identifier: BSD-3-Clause
// What a CameraInfo and a PointCloud2 say, read by the library's own rules.
#include "sensor_messages.hpp"

#include "arrays.hpp"

#include <clearance/io/compressed_depth.hpp>
#include <clearance/points/camera.hpp>
#include <clearance/points/point_cloud2.hpp>

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

using namespace clearance;

namespace {

std::vector<double> numbers_of(nb::handle given, const char* argument) {
  std::vector<double> values;
  try {
    const nb::object flat = nb::module_::import_("numpy").attr("asarray")(given, "f8").attr("ravel")();
    if (nb::try_cast(flat.attr("tolist")(), values)) return values;
  } catch (const nb::python_error&) {
  }
  throw std::invalid_argument(std::string("clearance: ") + argument + " is an array of numbers, not " +
                              shape_and_type(given));
}

template <class Whole>
Whole whole_of(nb::handle given, const std::string& argument) {
  Whole value{};
  if (!nb::try_cast(given, value))
    throw std::invalid_argument("clearance: " + argument + " is " + text_of(given) + ", which is no such number");
  return value;
}

camera camera_of(std::int64_t width, std::int64_t height, nb::handle k, nb::handle d, const std::string& model,
                 std::array<std::int64_t, 2> binning, std::array<std::int64_t, 4> roi) {
  const std::vector<double> matrix = numbers_of(k, "k"), coefficients = numbers_of(d, "d");
  if (matrix.size() != 9)
    throw std::invalid_argument("clearance: k is a matrix of shape (3, 3), not " + shape_and_type(k));
  camera_info info{.width = width,
                   .height = height,
                   .distortion_model = model,
                   .d = coefficients,
                   .binning_x = binning[0],
                   .binning_y = binning[1],
                   .roi = {roi[0], roi[1], roi[2], roi[3]}};
  std::ranges::copy(matrix, info.k.begin());
  return camera(info);
}

/// A camera, and what makes it again, for pickle.
struct camera_object : camera {
  nb::object recipe;
};

nb::object rays_of(const camera_object& seen) {
  ray_table table;
  {
    nb::gil_scoped_release others_run;
    table = seen.rays();
  }
  static_assert(sizeof(ray) == 2 * sizeof(real));
  auto* const kept = new std::vector<ray>(std::move(table.rays));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<ray>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, real>(&kept->data()->x, {table.height, table.width, 2}, owner));
}

/// How a PointCloud2's points lie in its data: offsets of x, y and z, bytes of a number, rows, columns, bytes from a
/// point to the next, and from a row to the next.
nb::tuple layout_of(nb::handle message, nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig> data) {
  std::vector<std::string> names;
  std::vector<point_field> fields;
  for (const nb::handle each : nb::object(message.attr("fields"))) names.push_back(text_of(each.attr("name")));
  const auto whole = [](nb::handle of, const char* name, const char* says) {
    return whole_of<std::uint32_t>(of.attr(name), std::string("the cloud's ") + says);
  };
  bool in_double = false;
  for (const nb::handle each : nb::object(message.attr("fields"))) {
    const std::string& name = names[fields.size()];
    const auto datatype = whole_of<std::uint8_t>(each.attr("datatype"), "the datatype of the cloud's field " + name);
    in_double |= name == "x" && datatype == point_field::float64;
    fields.push_back(
        {name, whole(each, "offset", "offset of a field"), datatype, whole(each, "count", "count of a field")});
  }
  const point_cloud2 cloud{.fields = fields,
                           .height = whole(message, "height", "height"),
                           .width = whole(message, "width", "width"),
                           .is_bigendian = bool(nb::bool_(message.attr("is_bigendian"))),
                           .point_step = whole(message, "point_step", "point_step"),
                           .row_step = whole(message, "row_step", "row_step"),
                           .data = std::as_bytes(std::span(data.data(), data.size()))};
  const auto layout = [&]<class Scalar>(Scalar) {
    const auto view = point_cloud2_view<Scalar>(cloud);
    return nb::make_tuple(nb::make_tuple(view.offset[0], view.offset[1], view.offset[2]), sizeof(Scalar), cloud.height,
                          cloud.width, view.step,
                          view.width != 0 ? view.row_step : cloud.width * std::size_t(view.step));
  };
  return in_double ? layout(double{}) : layout(float{});
}

/// The image of a CompressedImage, (rows, columns), and by how much less each depth may be, or None.
nb::tuple compressed_depth_of(const std::string& format,
                              nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig> data) {
  io::compressed_depth made;
  {
    const nb::gil_scoped_release others_run;
    made = io::read_compressed_depth(format, {reinterpret_cast<const char*>(data.data()), data.size()}, "the message");
  }
  const std::vector<std::size_t> shape{made.frame.height, made.frame.width};
  if (made.metres.empty()) return nb::make_tuple(own_array(std::move(made.frame.pixels), shape), nb::none());
  return nb::make_tuple(own_array(std::move(made.metres), shape), own_array(std::move(made.short_by), shape));
}

}  // namespace

void bind_sensor_messages(nb::module_& m) {
  nb::class_<camera_object>(m, "Camera", "A calibrated camera of a ROS CameraInfo: which ray each pixel sees.")
      .def(
          "__init__",
          [](camera_object* self, std::int64_t width, std::int64_t height, nb::handle k, nb::handle d,
             const std::string& model, std::array<std::int64_t, 2> binning, std::array<std::int64_t, 4> roi) {
            const nb::object copied = nb::module_::import_("copy").attr("deepcopy");
            new (self) camera_object{camera_of(width, height, k, d, model, binning, roi),
                                     nb::make_tuple(width, height, copied(k), copied(d), model, binning, roi)};
          },
          nb::arg("width"), nb::arg("height"), nb::arg("k"), nb::arg("d") = nb::make_tuple(),
          nb::arg("distortion_model") = "", nb::kw_only(), nb::arg("binning") = std::array<std::int64_t, 2>{0, 0},
          nb::arg("roi") = std::array<std::int64_t, 4>{0, 0, 0, 0},
          "width, height: pixels of the sensor. k: (3, 3), pixels. d: the coefficients of distortion_model (plumb_bob, "
          "rational_polynomial, equidistant, or none). binning: (x, y). roi: (x_offset, y_offset, width, height) in "
          "the "
          "sensor's pixels. Of a rectified image give P[:, :3] as k, and no d. ValueError if they contradict one "
          "another.")
      .def_prop_ro(
          "width", [](const camera_object& c) { return c.width(); }, "The width of the images, in pixels.")
      .def_prop_ro(
          "height", [](const camera_object& c) { return c.height(); }, "The height of the images, in pixels.")
      .def_prop_ro(
          "intrinsics",
          [](const camera_object& c) -> nb::object {
            const auto at = c.pinhole();
            return at ? nb::object(nb::make_tuple(at->fx, at->fy, at->cx, at->cy)) : nb::none();
          },
          "(fx, fy, cx, cy), pixels; None if the lens bends rays or pixels have skew: then rays() is needed.")
      .def("rays", &rays_of,
           "x / z and y / z of each pixel, (height, width, 2), float32: about a microsecond each. NaN where the lens "
           "folds or sees too wide, so the points of such pixels are dropped as not_finite. ValueError if all are.")
      .def("__reduce__",
           [](const camera_object& c) {
             return nb::make_tuple(nb::module_::import_("clearance._made").attr("camera"), c.recipe);
           })
      .def("__repr__", [](const camera_object& c) {
        return "<Camera of " + std::to_string(c.width()) + " x " + std::to_string(c.height()) + " pixels>";
      });
  m.def("_cloud_layout", &layout_of, nb::arg("message"), nb::arg("data"));
  m.def("_compressed_depth", &compressed_depth_of, nb::arg("format"), nb::arg("data"));
  m.def("_is_depth", [](const std::string& format) { return io::depth_format(format).has_value(); }, nb::arg("format"));
  m.def("_row_step", &row_step, nb::arg("rows"), nb::arg("row_bytes"), nb::arg("said"), nb::arg("held"));
}
