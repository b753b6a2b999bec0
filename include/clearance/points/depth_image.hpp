// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A pinhole camera's depth image as a cloud. Its points are computed as they are read.

#include <clearance/ground/read_only.hpp>
#include <clearance/points/extremes.hpp>
#include <clearance/points/point_filter.hpp>

namespace clearance::detail {

/// The least and largest depth of 128 pixels, and how many pixels hold none.
template <class Pixel>
struct depths {
  Pixel ends[2];
  std::uint32_t missing = 0, saturated = 0, not_finite = 0, minus_infinity = 0;
  bool strange = false;  ///< Some are so large that their points may fail is_finite.

  explicit depths(const std::uint16_t* pixels) {
    // 0 and 65535 are not depths: subtracting and adding one wraps them to the other end.
    std::uint16_t low = 65535, high = 0, zeros = 0, full = 0;
    for (std::size_t j = 0; j < surveyed_points; ++j) {
      const std::uint16_t d = pixels[j], less = std::uint16_t(d - 1), more = std::uint16_t(d + 1);
      low = less < low ? less : low;
      high = more > high ? more : high;
      zeros = std::uint16_t(zeros + (d == 0));
      full = std::uint16_t(full + (d == 65535));
    }
    missing = zeros;
    saturated = full;
    ends[0] = std::uint16_t(low + 1);
    ends[1] = std::uint16_t(high - 1);
  }
  explicit depths(const real* pixels) {
    std::uint32_t huge = 0;
    alignas(64) real depth[surveyed_points];
    for (std::size_t j = 0; j < surveyed_points; ++j) {
      const real d = pixels[j], size = std::abs(d);
      missing += d == 0;
      not_finite += !(size < infinity);
      huge += !(size <= 1e18f);
      depth[j] = d == 0 || !(size < infinity) ? not_a_number : d;
    }
    strange = huge != not_finite;
    if (not_finite != 0)
      for (std::size_t j = 0; j < surveyed_points; ++j) minus_infinity += pixels[j] == -infinity;
    not_finite -= minus_infinity;
    ends[0] = infinity;
    ends[1] = -infinity;
    spread(depth, ends[0], ends[1]);
  }
};

}  // namespace clearance::detail

namespace clearance {

/// Pinhole camera, in pixels. The centre of the first pixel is (0, 0). z points forward, x right, y down.
struct intrinsics {
  double fx, fy, cx, cy;
};

/// A depth image, deprojected while it is read: `std::uint16_t` pixels times `scale`, or `float` in metres (REP 118).
///
/// 0 is missing, 65535 in 16 bits is saturated, NaN and Inf are not finite, but -Inf is too close. `nearest` and
/// `farthest` bound z, in metres.
template <class Pixel>
struct depth_image {
  static_assert(std::is_same_v<Pixel, std::uint16_t> || std::is_same_v<Pixel, float>,
                "depth pixels are 16-bit integers or floats");
  using can = clearance::can<sources::image, sources::seeing, sources::ranged, sources::fetched, sources::surveyed,
                             sources::copied, sources::checked, sources::rounded>;

  const Pixel* pixels = nullptr;
  std::uint32_t width = 0, height = 0;
  std::uint32_t row = 0;  ///< Pixels from one row to the next.
  real scale = 1;         ///< Metres per unit.
  real nearest = 0, farthest = infinity;
  bool minus_infinity_is_near =
      true;  ///< A float pixel of -inf is `too_close` (REP 117); otherwise it is just not finite.
  real inverse_fx = 1, inverse_fy = 1, cx = 0, cy = 0;

  depth_image() = default;
  depth_image(const Pixel* pixels, std::uint32_t width, std::uint32_t height, intrinsics camera,
              double scale = std::is_same_v<Pixel, float> ? 1.0 : 0.001)
      : pixels(pixels),
        width(width),
        height(height),
        row(width),
        scale(real(scale)),
        inverse_fx(real(1 / camera.fx)),
        inverse_fy(real(1 / camera.fy)),
        cx(real(camera.cx)),
        cy(real(camera.cy)) {}

  CLEARANCE_HD std::size_t size() const { return std::size_t(width) * height; }
  std::uint32_t columns() const { return width; }
  CLEARANCE_HD sample operator[](std::size_t i) const {
    const std::uint32_t v = std::uint32_t(i) / width, u = std::uint32_t(i) - v * width;
    return deproject(pixels[std::size_t(v) * row + u], u, v);
  }

  /// See `beyond_range`.
  CLEARANCE_HD real beyond(std::size_t, vec3 p) const { return beyond_depths(p, nearest, farthest); }

  /// See `seeing_image`.
  CLEARANCE_HD vec3 way(std::size_t i) const {
    const std::uint32_t v = std::uint32_t(i) / width, u = std::uint32_t(i) - v * width;
    return {(real(u) - cx) * inverse_fx, (real(v) - cy) * inverse_fy, 1};
  }
  CLEARANCE_HD real depth(std::size_t i) const {
    const std::uint32_t v = std::uint32_t(i) / width, u = std::uint32_t(i) - v * width;
    return product(real(pixels[std::size_t(v) * row + u]), scale);
  }

  /// Four pixels of a row as they lie in memory; see `fetched_source`.
  struct alignas(4 * sizeof(Pixel)) four {
    Pixel d[4];
  };
  CLEARANCE_HD bool fetches() const {
    return row == width && width % 4 == 0 && reinterpret_cast<std::uintptr_t>(pixels) % 16 == 0;
  }
  using cursor = const four*;
  CLEARANCE_HD cursor seek(std::size_t i) const { return reinterpret_cast<const four*>(pixels) + i / 4; }
  CLEARANCE_HD cursor skip(cursor c, std::size_t n) const { return c + n / 4; }
  CLEARANCE_HD four fetch(cursor c) const { return read_only(c); }
  CLEARANCE_HD unsigned look(const four& r, std::size_t i, vec3 (&out)[4]) const {
    const std::uint32_t v = std::uint32_t(i) / width, u = std::uint32_t(i) - v * width;
    unsigned reasons = 0;
    CLEARANCE_UNROLL
    for (std::uint32_t j = 0; j < 4; ++j) {
      const sample s = deproject(r.d[j], u + j, v);
      out[j] = s.position;
      reasons |= unsigned(s.dropped) << 8 * j;
    }
    return reasons;
  }

  /// The point of pixel (u, v) if it holds `d`.
  CLEARANCE_HD sample deproject(Pixel d, std::uint32_t u, std::uint32_t v) const {
    const real z = product(real(d), scale);
    return depth_sample(d, {product((real(u) - cx) * inverse_fx, z), product((real(v) - cy) * inverse_fy, z), z},
                        nearest, farthest, minus_infinity_is_near);
  }

  /// See `surveyed_source`. Compares pixels and deprojects only the corners of their range: rounded arithmetic is
  /// monotonic.
  bool survey(std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) const {
    const std::size_t end = begin + surveyed_points - 1;
    const std::uint32_t v[2] = {std::uint32_t(begin / width), std::uint32_t(end / width)};
    if (v[0] != v[1] && row != width) return false;
    const std::uint32_t u[2] = {v[0] == v[1] ? std::uint32_t(begin % width) : 0,
                                v[0] == v[1] ? std::uint32_t(end % width) : width - 1};
    const detail::depths<Pixel> seen(pixels + std::size_t(v[0]) * row + begin % width);
    if (seen.strange) return false;
    box = {};
    if (seen.missing + seen.saturated + seen.not_finite + seen.minus_infinity < surveyed_points)
      for (const Pixel d : seen.ends)
        for (const std::uint32_t column : u)
          for (const std::uint32_t line : v) {
            const sample s = deproject(d, column, line);
            if (!s.valid()) return false;
            box.add(s.position);
          }
    dropped[int(drop_reason::missing)] += seen.missing;
    dropped[int(drop_reason::saturated)] += seen.saturated;
    dropped[int(drop_reason::not_finite)] += seen.not_finite;
    dropped[int(minus_infinity_is_near ? drop_reason::too_close : drop_reason::not_finite)] += seen.minus_infinity;
    return true;
  }

  /// See `rounding_of`. Mirrored images have a negative focal length.
  void check() const {
    if (size() == 0) return;
    detail::check_image(pixels, width, height, row, scale, nearest, farthest);
    for (const real f : {inverse_fx, inverse_fy})
      if (!is_finite(f) || f == 0)
        detail::refuse_source("a depth image has focal lengths of " + std::to_string(1 / inverse_fx) + " and " +
                              std::to_string(1 / inverse_fy) + " pixels; they must be numbers, and not 0");
    if (!is_finite(cx) || !is_finite(cy))
      detail::refuse_source("a depth image has a centre (cx, cy) that is not finite");
  }
  /// Scale, focal length and three products cost x and y six roundings, and z two. Those of cx and cy add a share of z.
  /// Without pixels nothing is lost.
  position_error rounding() const {
    if (size() == 0) return {};
    const auto square = [](double a) { return a * a; };
    const auto widest = [](double c, double n) { return std::fmax(std::fabs(c), std::fabs(n - 1 - c)); };
    const double slant =
        square(widest(cx, width) * inverse_fx) + square(widest(cy, height) * inverse_fy);  // the outermost ray's
    const double centre = std::sqrt(square(double(cx) * inverse_fx) + square(double(cy) * inverse_fy));
    return {0, 0x1.001p-24 * (std::sqrt((36 * slant + 4) / (slant + 1)) + centre)};
  }

  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(pixels, std::size_t(row) * height)); }
  /// The memory that points `begin` to `end - 1` need: their rows.
  std::span<const std::byte> bytes(std::size_t begin, std::size_t end) const {
    if (begin == end) return {};
    const std::size_t first = begin / width, count = (end - 1) / width + 1 - first;
    return std::as_bytes(std::span(pixels + first * row, count * row));
  }
  depth_image at(const std::byte* copy) const {
    depth_image moved = *this;
    moved.pixels = reinterpret_cast<const Pixel*>(copy);
    return moved;
  }
};

static_assert(fetched_source<depth_image<std::uint16_t>> && image_source<depth_image<float>> &&
              surveyed_source<depth_image<float>>);

}  // namespace clearance
