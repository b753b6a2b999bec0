// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A camera and its lens, from a ROS CameraInfo, as what depth_image and ray_image take, without ROS.

#include <clearance/ground/borrowed.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/ray_image.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <ranges>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

namespace clearance {

// Where a lens shows a ray, and which ray it shows at a place. In double, on the host, once for each camera.

/// A direction or a place in an image: x and y at z = 1, in the camera's frame.
struct at_one {
  double x, y;
};

/// OpenCV's lens: `k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4` (radial, tangential, rational, thin prism); the rest is 0.
struct brown_lens {
  std::array<double, 12> d{};

  /// Where a ray is seen, how that changes with it, and whether it keeps its orientation there.
  struct seen {
    double x, y, x_by_x, x_by_y, y_by_x, y_by_y;
    bool unfolded;
  };
  seen shown(at_one ray) const {
    const auto [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = d;
    const auto [x, y] = ray;
    const double r = x * x + y * y, under = 1 + r * (k4 + r * (k5 + r * k6));
    const double radial = (1 + r * (k1 + r * (k2 + r * k3))) / under;
    const double slope = (k1 + r * (2 * k2 + 3 * r * k3) - radial * (k4 + r * (2 * k5 + 3 * r * k6))) / under;
    const double prism_x = 2 * (s1 + 2 * r * s2), prism_y = 2 * (s3 + 2 * r * s4);
    const double across = 2 * (x * y * slope + p1 * x + p2 * y);
    seen s{x * radial + 2 * p1 * x * y + p2 * (r + 2 * x * x) + r * (s1 + r * s2),
           y * radial + 2 * p2 * x * y + p1 * (r + 2 * y * y) + r * (s3 + r * s4),
           radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x + x * prism_x,
           across + y * prism_x,
           across + x * prism_y,
           radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x + y * prism_y,
           false};
    s.unfolded = under > 0 && s.x_by_x * s.y_by_y - s.x_by_y * s.y_by_x > 0;
    return s;
  }
  at_one project(at_one ray) const {
    const seen s = shown(ray);
    return {s.x, s.y};
  }

  /// The ray that is seen at a place: by Newton's method, with steps that are shortened until they help. None if that
  /// does not converge, or if the lens folds between the centre and the ray: then the place shows several rays.
  std::optional<at_one> unproject(at_one place) const {
    const auto off = [&](const seen& s) { return std::hypot(s.x - place.x, s.y - place.y); };
    at_one ray = place;
    seen s = shown(ray);
    for (int turns = 0; turns < 100; ++turns) {
      const double turn = s.x_by_x * s.y_by_y - s.x_by_y * s.y_by_x, ex = s.x - place.x, ey = s.y - place.y;
      const double dx = (s.y_by_y * ex - s.x_by_y * ey) / turn, dy = (s.x_by_x * ey - s.y_by_x * ex) / turn;
      if (std::hypot(dx, dy) <= 1e-11 * (1 + std::hypot(ray.x, ray.y))) return reached(ray);
      const double before = off(s);
      double share = 1;
      for (; share > 1e-4; share /= 2) {
        const at_one next{ray.x - share * dx, ray.y - share * dy};
        const seen seen_next = shown(next);
        if (!(off(seen_next) < before)) continue;
        ray = next;
        s = seen_next;
        break;
      }
      if (!(share > 1e-4)) return {};
    }
    return {};
  }

 private:
  std::optional<at_one> reached(at_one ray) const {
    constexpr int samples = 64;
    for (int k = samples; k > 0; --k)
      if (!shown({ray.x * k / samples, ray.y * k / samples}).unfolded) return {};
    return ray;
  }
};

/// OpenCV's fisheye lens (ROS: equidistant): a ray at an angle a from the axis is seen a (1 + k1 a^2 + ... + k4 a^8)
/// from the centre.
class fisheye_lens {
 public:
  /// The widest angle of a ray, in radians: depth along the axis says nothing about wider ones.
  static constexpr double widest = 1.55;

  explicit fisheye_lens(const std::array<double, 4>& k) : k_(k) {
    constexpr int samples = 4096;
    for (int n = 1; n <= samples && slope(widest * n / samples) > 0; ++n) limit_ = widest * n / samples;
  }

  at_one project(at_one ray) const {
    const double r = std::hypot(ray.x, ray.y), by = r > 0 ? radius(std::atan(r)) / r : 1;
    return {ray.x * by, ray.y * by};
  }
  /// The ray that is seen at a place. None where the ray would be too wide, or beyond where the lens folds.
  std::optional<at_one> unproject(at_one place) const {
    const double r = std::hypot(place.x, place.y);
    if (!(r <= radius(limit_))) return {};
    double low = 0, high = limit_, angle = std::fmin(r, limit_);
    for (int turns = 0; turns < 200 && high - low > 0; ++turns) {  // between the two the radius grows
      const double off = radius(angle) - r;
      (off > 0 ? high : low) = angle;
      double next = angle - off / slope(angle);
      if (!(next > low && next < high)) next = low + (high - low) / 2;
      if (off == 0 || std::fabs(next - angle) <= 4e-16 * angle) break;
      angle = next;
    }
    const double by = r > 0 ? std::tan(angle) / r : 1;
    return at_one{place.x * by, place.y * by};
  }

 private:
  double radius(double a) const {
    const double s = a * a;
    return a * (1 + s * (k_[0] + s * (k_[1] + s * (k_[2] + s * k_[3]))));
  }
  double slope(double a) const {
    const double s = a * a;
    return 1 + s * (3 * k_[0] + s * (5 * k_[1] + s * (7 * k_[2] + s * 9 * k_[3])));
  }

  std::array<double, 4> k_;
  double limit_ = 0;  // up to here the radius grows with the angle
};

/// What a CameraInfo says, by its names. R is left out: it turns a camera into a rectified one, and this is about the
/// camera itself. Of a rectified image give the first three columns of P as `k`, and neither `d` nor a model.
struct camera_info {
  std::int64_t width = 0, height = 0;  ///< Pixels of the sensor.
  borrowed_text distortion_model;      ///< plumb_bob, rational_polynomial, equidistant (fisheye), or none.
  borrowed<double> d;
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
                                                      std::size_t row = 0) const&;
  template <class... Any>
  void image(const Any&...) const&& = delete;  // the rays would be gone before they are read; give the table a name
  template <owning_range Pixels, class... Size>
  void image(const Pixels&&,
             Size...) const& = delete;  // the pixels would be gone before they are read; give them a name
};

/// A calibrated camera, with its lens, its binning and its region. Made once, when a CameraInfo comes or changes.
class camera {
 public:
  /// Throws std::invalid_argument, with a sentence, if numbers are not finite or contradict one another, if there is no
  /// focal length, or if the model is unknown.
  explicit camera(const camera_info& info);

  std::uint32_t width() const { return width_; }    ///< Columns of an image.
  std::uint32_t height() const { return height_; }  ///< Rows of an image.
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
  /// The ray of a pixel. None if the lens shows none or several at that place, or if the way back misses the pixel.
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
                                                               std::uint32_t high, std::size_t row) const& {
  detail::require_camera(
      wide == width && high == height,
      "has rays for " + detail::pixels(width, height) + " pixels, but the image has " + detail::pixels(wide, high));
  detail::require_camera(
      rays.size() == std::size_t(width) * height,
      "has " + std::to_string(rays.size()) + " rays for " + detail::pixels(width, height) + " pixels");
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
  width_ = std::uint32_t(double(wide) / bin_x);
  height_ = std::uint32_t(double(high) / bin_y);
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
