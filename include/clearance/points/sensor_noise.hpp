// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far a sensor's point may be from the place that it measured: `k` standard deviations, by kind of sensor.

#include <clearance/ground/borrowed.hpp>
#include <clearance/point_source.hpp>

#include <stdexcept>
#include <string>

namespace clearance {

/// How noisy a sensor's points are.
/// Law: `n(i, p)` is a radius in metres around point i, whose place is p, in the sensor's frame; pure, with the same
/// bits on every backend (`clearance::fma`, `product`, `divide`). Below 0, NaN and 1e6 m or more: the point may be
/// anywhere. Optional: `check(points)` throws std::invalid_argument for options that cannot be.
/// Optional law: `n.slice(begin, end)` is the noise of points `begin` to `end - 1` as a cloud of their own; else every
/// noise can be sliced, too, but its slices are of another type.
/// Optional law: no radius of 128 neighbours from number `begin` on is above `n.most(begin, box)`, if all are in the
/// box.
template <class N>
concept sensor_noise = std::is_trivially_copyable_v<N> && requires(const N n, std::size_t i, vec3 p) {
  { n(i, p) } -> std::same_as<real>;
};

namespace detail {

/// Throws std::invalid_argument unless `x` is finite and not negative.
inline void check_uncertain(double x, const char* what) {
  if (!(x >= 0 && x <= double(largest_real)))
    throw std::invalid_argument(std::string("clearance: ") + what + " is " + std::to_string(x) +
                                ", which must be 0 or more");
}

/// A reading is uncertain along z, and its pixel is certain. So its place moves along the pixel's ray, which is longer.
/// NaN for what no camera sees, behind it.
CLEARANCE_HD inline real along_ray(real deviation, vec3 p) {
  if (p == vec3{0, 0, 0}) return deviation;
  return p.z > 0 ? product(deviation, divide(length(p), p.z)) : not_a_number;
}

/// The largest of the radii of 128 points, `radius(j)` each; infinite if one is none.
template <class Radius>
real most_radius(const Radius& radius) {
  real least = 0, most = 0;
  bool ordered = true;
  for (std::size_t j = 0; j < surveyed_points; ++j) {
    const real r = radius(j);
    least = min(least, r);
    most = max(most, r);
    ordered &= r == r;
  }
  return ordered && least >= 0 ? most : infinity;
}

/// The largest length and slant of what is in a box.
inline real farthest_in(const extent& box) {
  const auto most = [](real a, real b) { return max(absolute(a), absolute(b)); };
  return length({most(box.lower.x, box.upper.x), most(box.lower.y, box.upper.y), most(box.lower.z, box.upper.z)});
}
/// The largest `along_ray` in a box, for a deviation that is nowhere larger. More than rounding takes.
inline real most_along_ray(real deviation, const extent& box) {
  if (!(box.lower.z > 0)) return infinity;
  return deviation * (farthest_in(box) / box.lower.z) * (1 + slack);
}

}  // namespace detail

/// The noise of the points from number `first` on.
template <sensor_noise N>
struct noise_from {
  N whole;
  std::size_t first;

  CLEARANCE_HD real operator()(std::size_t i, vec3 p) const { return whole(first + i, p); }
  real most(std::size_t begin, const extent& box) const
    requires requires(const N n, std::size_t i, extent e) { n.most(i, e); }
  {
    return whole.most(first + begin, box);
  }
  noise_from slice(std::size_t begin, std::size_t) const { return {whole, first + begin}; }
};

/// The noise of points `begin` to `end - 1`, by its own `slice` if it has one.
template <sensor_noise N>
auto slice(const N& noise, std::size_t begin, std::size_t end) {
  if constexpr (requires {
                  { noise.slice(begin, end) } -> sensor_noise;
                })
    return noise.slice(begin, end);
  else
    return noise_from<N>{noise, begin};
}

/// The sensor measures without noise.
struct no_noise {
  CLEARANCE_HD real operator()(std::size_t, vec3) const { return 0; }
  real most(std::size_t, const extent&) const { return 0; }
  no_noise slice(std::size_t, std::size_t) const { return *this; }
};

/// Microsoft's first Kinect: 1.2 mm + 1.9 mm/m^2 (z - 0.4 m)^2 along z. Nguyen, Izadi, Lovell, "Modeling Kinect sensor
/// noise for improved 3D reconstruction and tracking", 3DIMPVT 2012. They measured walls at up to 60 degrees.
struct kinect_noise {
  real k = 3;  ///< How many standard deviations a point may be off.

  CLEARANCE_HD real operator()(std::size_t, vec3 p) const {
    const real z = p.z - 0.4f;
    return detail::along_ray(product(k, fma(0.0019f, product(z, z), 0.0012f)), p);
  }
  real most(std::size_t, const extent& box) const {
    const real z = max(absolute(box.lower.z - 0.4f), absolute(box.upper.z - 0.4f));
    return detail::most_along_ray(k * (0.0019f * z * z + 0.0012f) * (1 + slack), box);
  }
  void check(std::size_t) const { detail::check_uncertain(k, "the noise's k"); }
  kinect_noise slice(std::size_t, std::size_t) const { return *this; }
};

/// Stereo, active or passive, and structured light: z^2 s / (f B) along z. Gallup et al., "Variable baseline/resolution
/// stereo", CVPR 2008; for structured light Khoshelham and Elberink, Sensors 12(2), 2012.
struct stereo_noise {
  real focal_length;  ///< The focal length f, in pixels.
  real baseline;      ///< The distance B between the cameras, in metres.
  real disparity;     ///< The standard deviation s of a disparity, in pixels.
  real k = 3;         ///< How many standard deviations a point may be off.

  CLEARANCE_HD real operator()(std::size_t, vec3 p) const {
    const real each = divide(product(k, disparity), product(focal_length, baseline));
    return detail::along_ray(product(product(p.z, p.z), each), p);
  }
  real most(std::size_t, const extent& box) const {
    const real z = box.upper.z;
    return detail::most_along_ray(z * z * (k * disparity / (focal_length * baseline)) * (1 + slack), box);
  }
  void check(std::size_t) const {
    detail::check_uncertain(k, "the noise's k");
    detail::check_uncertain(disparity, "a stereo camera's disparity");
    for (const real x : {focal_length, baseline})
      if (!(x > 0 && x <= largest_real))
        throw std::invalid_argument("clearance: a stereo camera's focal length and baseline are " +
                                    std::to_string(focal_length) + " pixels and " + std::to_string(baseline) +
                                    " m, which must be above 0");
  }
  stereo_noise slice(std::size_t, std::size_t) const { return *this; }
};

/// Time of flight: constant + square |p|^2, because light that returns falls with the square of the way. Lange and
/// Seitz, "Solid-state time-of-flight range camera", IEEE Journal of Quantum Electronics 37(3), 2001.
struct tof_noise {
  real constant;  ///< The standard deviation at distance 0, in metres.
  real square;    ///< What the deviation grows by for each square metre of squared distance, in metres.
  real k = 3;     ///< How many standard deviations a point may be off.

  CLEARANCE_HD real operator()(std::size_t, vec3 p) const { return product(k, fma(square, dot(p, p), constant)); }
  real most(std::size_t, const extent& box) const {
    const real away = detail::farthest_in(box);
    return k * (square * away * away + constant) * (1 + slack);
  }
  void check(std::size_t) const {
    detail::check_uncertain(k, "the noise's k");
    detail::check_uncertain(constant, "a time of flight camera's constant");
    detail::check_uncertain(square, "what a time of flight camera's noise grows by");
  }
  tof_noise slice(std::size_t, std::size_t) const { return *this; }
};

/// LiDAR: constant + share |p|, as data sheets say it. Glennie and Lichti, "Static calibration and analysis of the
/// Velodyne HDL-64E S2", Remote Sensing 2(6), 2010.
struct lidar_noise {
  real constant;   ///< The standard deviation at distance 0, in metres.
  real share = 0;  ///< What the deviation grows by for each metre of distance, in metres.
  real k = 3;      ///< How many standard deviations a point may be off.

  CLEARANCE_HD real operator()(std::size_t, vec3 p) const { return product(k, fma(share, length(p), constant)); }
  real most(std::size_t, const extent& box) const {
    return k * (share * detail::farthest_in(box) + constant) * (1 + slack);
  }
  void check(std::size_t) const {
    detail::check_uncertain(k, "the noise's k");
    detail::check_uncertain(constant, "a LiDAR's constant");
    detail::check_uncertain(share, "what a LiDAR's noise grows by");
  }
  lidar_noise slice(std::size_t, std::size_t) const { return *this; }
};

/// A radius for each point, in metres.
struct point_radii {
  const real* radii;
  std::size_t count;

  /// In memory that the query's backend reads. They are not looked at before.
  CLEARANCE_HD point_radii(const real* radii, std::size_t count) : radii(radii), count(count) {}
  /// In host memory. Throws std::invalid_argument if one is negative or not finite.
  explicit point_radii(std::span<const real> all) : point_radii(all.data(), all.size()) {
    for (std::size_t i = 0; i < count; ++i)
      if (!(radii[i] >= 0 && radii[i] <= largest_real))
        throw std::invalid_argument("clearance: the radius of point " + std::to_string(i) + " is " +
                                    std::to_string(radii[i]) + " m, which must be 0 or more");
  }

  template <owning_range R>
  explicit point_radii(const R&&) = delete;  // the radii would be gone before they are read; name them

  CLEARANCE_HD real operator()(std::size_t i, vec3) const { return radii[i]; }
  /// Infinite if one is none.
  real most(std::size_t begin, const extent&) const {
    return detail::most_radius([&](std::size_t j) { return radii[begin + j]; });
  }
  void check(std::size_t points) const {
    if (radii == nullptr && count != 0)
      throw std::invalid_argument("clearance: there are " + std::to_string(count) + " radii, but they are null");
    if (points != count)
      throw std::invalid_argument("clearance: there are " + std::to_string(points) + " points, but " +
                                  std::to_string(count) + " radii");
  }
  point_radii slice(std::size_t begin, std::size_t end) const { return {radii + begin, end - begin}; }
};

/// The kind of a sensor that a program learns while it runs.
enum class noise_kind : std::uint8_t { none, kinect, stereo, tof, lidar, radii };

/// The noise of one of these kinds.
struct any_noise {
  noise_kind kind = noise_kind::none;
  kinect_noise kinect = {};
  stereo_noise stereo = {1, 1, 0};
  tof_noise tof = {0, 0};
  lidar_noise lidar = {0};
  point_radii radii = {nullptr, 0};

  CLEARANCE_HD real operator()(std::size_t i, vec3 p) const {
    switch (kind) {
      case noise_kind::kinect:
        return kinect(i, p);
      case noise_kind::stereo:
        return stereo(i, p);
      case noise_kind::tof:
        return tof(i, p);
      case noise_kind::lidar:
        return lidar(i, p);
      case noise_kind::radii:
        return radii(i, p);
      default:
        return 0;
    }
  }
  real most(std::size_t begin, const extent& box) const {
    switch (kind) {
      case noise_kind::kinect:
        return kinect.most(begin, box);
      case noise_kind::stereo:
        return stereo.most(begin, box);
      case noise_kind::tof:
        return tof.most(begin, box);
      case noise_kind::lidar:
        return lidar.most(begin, box);
      case noise_kind::radii:
        return radii.most(begin, box);
      default:
        return 0;
    }
  }
  void check(std::size_t points) const {
    if (kind > noise_kind::radii)
      throw std::invalid_argument("clearance: there is no kind of noise number " + std::to_string(int(kind)));
    kinect.check(points);
    stereo.check(points);
    tof.check(points);
    lidar.check(points);
    if (kind == noise_kind::radii) radii.check(points);
  }
  any_noise slice(std::size_t begin, std::size_t end) const {
    any_noise piece = *this;
    if (kind == noise_kind::radii) piece.radii = radii.slice(begin, end);
    return piece;
  }
};

}  // namespace clearance
