// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A ROS CameraInfo as what depth_image and ray_image take, without ROS.

#include <clearance/points/depth_image.hpp>
#include <clearance/points/lens.hpp>
#include <clearance/points/ray_image.hpp>

#include <algorithm>
#include <ranges>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

namespace clearance {

/// What a CameraInfo says, by its names. R is not here: it turns a camera into a rectified one, and this is about the
/// camera itself. Of a rectified image give the first three columns of P as `k`, and neither `d` nor a model.
struct camera_info {
  std::int64_t width = 0, height = 0;  ///< Pixels of the sensor.
  std::string_view distortion_model;   ///< plumb_bob, rational_polynomial, equidistant (fisheye), or none.
  std::span<const double> d;
  std::array<double, 9> k{};                  ///< Row by row.
  std::int64_t binning_x = 0, binning_y = 0;  ///< 0 and 1: none.
  struct region {
    std::int64_t x_offset = 0, y_offset = 0, width = 0, height = 0;
  } roi = {};  ///< In the sensor's pixels; without width and height all of it.
};

/// The rays of all pixels, for ray_image: of an image of this size.
struct ray_table {
  std::uint32_t width = 0, height = 0;
  std::vector<ray> rays;  ///< Row by row.
  std::size_t blind = 0;  ///< Pixels without a ray. Theirs is NaN, so that their points are dropped as `not_finite`.

  /// An image of this camera, 16-bit integers or floats, whose rows begin `row` pixels apart (0: width). It views the
  /// pixels and these rays. Throws std::invalid_argument if it has another size, or fewer pixels than it says.
  template <std::ranges::contiguous_range Pixels>
  ray_image<std::ranges::range_value_t<Pixels>> image(const Pixels& pixels, std::uint32_t wide, std::uint32_t high,
                                                      std::size_t row = 0) const;
};

/// A calibrated camera, with its lens, its binning and its region. Made once, when a CameraInfo comes or changes.
class camera {
 public:
  /// Throws std::invalid_argument, with a sentence, if numbers are not finite or contradict one another, if there is no
  /// focal length, or if the model is unknown.
  explicit camera(const camera_info& info);

  std::uint32_t width() const { return width_; }  ///< Of the images, in pixels.
  std::uint32_t height() const { return height_; }
  /// What depth_image takes, if the lens bends no ray and pixels have no skew.
  std::optional<intrinsics> pinhole() const {
    if (!std::holds_alternative<std::monostate>(lens_) || skew_ != 0) return {};
    return at_;
  }
  /// Where the ray (x, y, 1) is seen, in pixels.
  at_one pixel(at_one ray) const {
    const at_one seen = std::visit([&](const auto& lens) { return bent(lens, ray); }, lens_);
    return {at_.fx * seen.x + skew_ * seen.y + at_.cx, at_.fy * seen.y + at_.cy};
  }
  /// The ray of a pixel. None if the lens shows none there or several, or if the way back misses the pixel.
  std::optional<at_one> ray_of(double u, double v) const {
    const double y = (v - at_.cy) / at_.fy, x = (u - at_.cx - skew_ * y) / at_.fx;
    const auto ray = std::visit([&](const auto& lens) { return straight(lens, {x, y}); }, lens_);
    if (!ray) return {};
    const at_one back = pixel(*ray);
    if (!(std::hypot(back.x - u, back.y - v) <= 1e-6)) return {};
    return ray;
  }
  /// All pixels' rays: about a microsecond each. Throws std::invalid_argument if no pixel has one.
  ray_table rays() const;

 private:
  template <class Lens>
  static at_one bent(const Lens& lens, at_one ray) {
    return lens.project(ray);
  }
  static at_one bent(std::monostate, at_one ray) { return ray; }
  template <class Lens>
  static std::optional<at_one> straight(const Lens& lens, at_one place) {
    return lens.unproject(place);
  }
  static std::optional<at_one> straight(std::monostate, at_one place) { return place; }
  void take_lens(const camera_info& info);

  std::uint32_t width_, height_;
  intrinsics at_;
  double skew_;
  std::variant<std::monostate, brown_lens, fisheye_lens> lens_;
};

namespace detail {
inline void require_camera(bool holds, const std::string& otherwise) {
  if (!holds) throw std::invalid_argument("clearance: the camera " + otherwise);
}
inline std::string pixels(std::int64_t wide, std::int64_t high) {
  return std::to_string(wide) + " x " + std::to_string(high);
}
}  // namespace detail

template <std::ranges::contiguous_range Pixels>
ray_image<std::ranges::range_value_t<Pixels>> ray_table::image(const Pixels& pixels, std::uint32_t wide,
                                                               std::uint32_t high, std::size_t row) const {
  detail::require_camera(
      wide == width && high == height,
      "has rays for " + detail::pixels(width, height) + " pixels, but the image has " + detail::pixels(wide, high));
  if (row == 0) row = wide;
  const std::size_t held = std::ranges::size(pixels), needed = (std::size_t(high) - 1) * row + wide;
  detail::require_camera(row >= wide && row <= UINT32_MAX && held >= needed,
                         "has an image of " + detail::pixels(wide, high) + " pixels in rows of " + std::to_string(row) +
                             ", but it holds " + std::to_string(held));
  ray_image<std::ranges::range_value_t<Pixels>> made(std::ranges::data(pixels), rays.data(), wide, high);
  made.row = std::uint32_t(row);
  return made;
}

inline camera::camera(const camera_info& info) {
  using detail::pixels;
  const auto& roi = info.roi;
  const auto within = [](std::int64_t x, std::int64_t low, std::int64_t high) { return x >= low && x <= high; };
  detail::require_camera(within(info.width, 1, 65535) && within(info.height, 1, 65535),
                         "has " + pixels(info.width, info.height) + " pixels");
  detail::require_camera(within(info.binning_x, 0, info.width) && within(info.binning_y, 0, info.height),
                         "bins " + pixels(info.binning_x, info.binning_y) + " pixels");
  const std::int64_t wide = roi.width == 0 ? info.width : roi.width, high = roi.height == 0 ? info.height : roi.height;
  detail::require_camera(within(wide, 1, info.width) && within(high, 1, info.height) &&
                             within(roi.x_offset, 0, info.width - wide) && within(roi.y_offset, 0, info.height - high),
                         "has a region of " + pixels(wide, high) + " pixels at " + pixels(roi.x_offset, roi.y_offset) +
                             " that reaches beyond its " + pixels(info.width, info.height));
  const double bin_x = double(std::max<std::int64_t>(1, info.binning_x)),
               bin_y = double(std::max<std::int64_t>(1, info.binning_y));
  width_ = std::uint32_t(double(wide) / bin_x), height_ = std::uint32_t(double(high) / bin_y);
  detail::require_camera(width_ > 0 && height_ > 0, "bins more pixels than its region has");

  const auto& k = info.k;
  const auto finite = [](double x) { return std::isfinite(x); };
  detail::require_camera(std::ranges::all_of(k, finite), "has a number in K that is not finite");
  detail::require_camera(k[0] > 0 && k[4] > 0, "is not calibrated: its focal lengths are " + std::to_string(k[0]) +
                                                   " and " + std::to_string(k[4]));
  detail::require_camera(k[3] == 0 && k[6] == 0 && k[7] == 0 && k[8] == 1,
                         "has a K that is not (fx, skew, cx; 0, fy, cy; 0, 0, 1)");
  // Pixel u of the image is pixel u * binning + offset of the sensor.
  at_ = {k[0] / bin_x, k[4] / bin_y, (k[2] - double(roi.x_offset)) / bin_x, (k[5] - double(roi.y_offset)) / bin_y};
  skew_ = k[1] / bin_x;
  detail::require_camera(std::ranges::all_of(info.d, finite), "has a number in D that is not finite");
  take_lens(info);
}

inline void camera::take_lens(const camera_info& info) {
  const std::string_view model = info.distortion_model;
  const std::size_t n = info.d.size();
  const std::string has = "has a lens '" + std::string(model) + "' with " + std::to_string(n) + " coefficients; ";
  const bool bends = std::ranges::any_of(info.d, [](double x) { return x != 0; });
  if (model == "equidistant" || model == "fisheye") {
    detail::require_camera(n == 4, has + "known are 4");
    lens_ = fisheye_lens({info.d[0], info.d[1], info.d[2], info.d[3]});
  } else if (model == "plumb_bob" || model == "rational_polynomial") {
    const bool upright = n == 14 && info.d[12] == 0 && info.d[13] == 0;  // OpenCV's tilted sensor, not tilted
    detail::require_camera(n == 0 || n == 4 || n == 5 || n == 8 || n == 12 || upright,
                           has + "known are 0, 4, 5, 8 and 12");
    brown_lens lens;
    std::ranges::copy(info.d.first(std::min(n, lens.d.size())), lens.d.begin());
    if (bends) lens_ = lens;
  } else {
    detail::require_camera((model.empty() || model == "none" || model == "None") && !bends,
                           has + "known are plumb_bob, rational_polynomial and equidistant");
  }
}

inline ray_table camera::rays() const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  ray_table table{width_, height_, {}, 0};
  table.rays.reserve(std::size_t(width_) * height_);
  for (std::uint32_t v = 0; v < height_; ++v)
    for (std::uint32_t u = 0; u < width_; ++u) {
      const auto found = ray_of(u, v);
      table.blind += !found;
      const at_one ray = found.value_or(at_one{nan, nan});
      table.rays.push_back({real(ray.x), real(ray.y)});
    }
  detail::require_camera(table.blind < table.rays.size(), "has a lens whose distortion leaves no pixel a ray");
  return table;
}

}  // namespace clearance
