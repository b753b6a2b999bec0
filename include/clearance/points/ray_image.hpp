// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A depth image of a lens with distortion as a cloud, by a table with the ray of each pixel.

#include <clearance/ground/read_only.hpp>
#include <clearance/points/point_filter.hpp>

#include <cmath>
#include <numbers>

namespace clearance {

/// The direction of a pixel: x and y at z = 1, in the camera's frame.
struct ray {
  real x, y;
};

/// A depth image of a lens with distortion. Each pixel has a ray, from a table that is made once (one per pixel, row by
/// row, in memory that the query's backend can read; the pixels may be anywhere). Otherwise as depth_image.
template <class Pixel>
struct ray_image {
  static_assert(std::is_same_v<Pixel, std::uint16_t> || std::is_same_v<Pixel, float>,
                "depth pixels are 16-bit integers or floats");
  using can = clearance::can<sources::image, sources::seeing, sources::ranged, sources::fetched, sources::copied,
                             sources::checked, sources::rounded>;

  const Pixel* pixels = nullptr;
  const ray* rays = nullptr;
  std::uint32_t width = 0, height = 0;
  std::uint32_t row = 0;  ///< Pixels from one row to the next; the table has no padding.
  real scale = 1;         ///< Metres per unit.
  real nearest = 0, farthest = infinity;
  bool minus_infinity_is_near =
      true;  ///< A float pixel of -inf is `too_close` (REP 117); otherwise it is just not finite.

  ray_image() = default;
  ray_image(const Pixel* pixels, const ray* rays, std::uint32_t width, std::uint32_t height,
            double scale = std::is_same_v<Pixel, float> ? 1.0 : 0.001)
      : pixels(pixels), rays(rays), width(width), height(height), row(width), scale(real(scale)) {}

  CLEARANCE_HD std::size_t size() const { return std::size_t(width) * height; }
  std::uint32_t columns() const { return width; }
  CLEARANCE_HD sample operator[](std::size_t i) const {
    return along(rays[i], pixels[row == width ? i : i / width * row + i % width]);
  }

  /// See `beyond_range`.
  CLEARANCE_HD real beyond(std::size_t, vec3 p) const { return beyond_depths(p, nearest, farthest); }

  /// See `seeing_image`.
  CLEARANCE_HD vec3 way(std::size_t i) const { return {rays[i].x, rays[i].y, 1}; }
  CLEARANCE_HD real depth(std::size_t i) const {
    return product(real(pixels[row == width ? i : i / width * row + i % width]), scale);
  }

  /// Four pixels and their rays as they lie in memory; see `fetched_source`.
  struct alignas(4 * sizeof(Pixel)) four_pixels {
    Pixel d[4];
  };
  struct alignas(16) four_rays {
    ray r[4];
  };
  struct four {
    four_pixels pixels;
    four_rays rays;
  };
  struct cursor {
    const four_pixels* pixels;
    const four_rays* rays;
  };
  CLEARANCE_HD bool fetches() const {
    const auto aligned = [](const void* p) { return reinterpret_cast<std::uintptr_t>(p) % 16 == 0; };
    return row == width && aligned(pixels) && aligned(rays);
  }
  CLEARANCE_HD cursor seek(std::size_t i) const {
    return {reinterpret_cast<const four_pixels*>(pixels) + i / 4, reinterpret_cast<const four_rays*>(rays) + i / 4};
  }
  CLEARANCE_HD cursor skip(cursor c, std::size_t n) const { return {c.pixels + n / 4, c.rays + n / 4}; }
  CLEARANCE_HD four fetch(cursor c) const { return {read_only(c.pixels), read_only(c.rays)}; }
  CLEARANCE_HD unsigned look(const four& f, std::size_t, vec3 (&out)[4]) const {
    unsigned reasons = 0;
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j) {
      const sample s = along(f.rays.r[j], f.pixels.d[j]);
      out[j] = s.position;
      reasons |= unsigned(s.dropped) << 8 * j;
    }
    return reasons;
  }

  /// See `rounding_of`.
  void check() const {
    if (size() == 0) return;
    detail::check_image(pixels, width, height, row, scale, nearest, farthest);
    if (rays == nullptr) detail::refuse_source("a ray image has no rays: they are null");
  }
  /// The roundings of scale, ray and two products. Without pixels nothing is lost.
  position_error rounding() const { return {0, size() == 0 ? 0 : 4 * 0x1.001p-24}; }

  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(pixels, std::size_t(row) * height)); }
  /// The memory that points `begin` to `end - 1` need: their rows.
  std::span<const std::byte> bytes(std::size_t begin, std::size_t end) const {
    if (begin == end) return {};
    const std::size_t first = begin / width, count = (end - 1) / width + 1 - first;
    return std::as_bytes(std::span(pixels + first * row, count * row));
  }
  ray_image at(const std::byte* copy) const {
    ray_image moved = *this;
    moved.pixels = reinterpret_cast<const Pixel*>(copy);
    return moved;
  }

 private:
  CLEARANCE_HD sample along(ray r, Pixel d) const {
    const real z = product(real(d), scale);
    return depth_sample(d, {product(r.x, z), product(r.y, z), z}, nearest, farthest, minus_infinity_is_near);
  }
};

static_assert(fetched_source<ray_image<std::uint16_t>> && image_source<ray_image<float>> &&
              fetched_source<ray_image<float>>);

/// Half the diagonal of the widest pixel of a ray table, at z = 1, in host memory. In a single row or column a pixel is
/// taken to be as wide one way as the other; a single ray tells nothing, and has 0, which `unseen` refuses.
inline double half_pixel_of(const ray* rays, std::size_t width, std::size_t height) {
  double widest = 0;
  const auto apart = [&](std::size_t i, std::size_t j) {
    const double d = std::hypot(double(rays[i].x) - rays[j].x, double(rays[i].y) - rays[j].y) / 2;
    if (d > widest) widest = d;
  };
  for (std::size_t v = 0; v + 1 < height; ++v)
    for (std::size_t u = 0; u + 1 < width; ++u) {
      const std::size_t i = v * width + u;
      apart(i, i + width + 1);
      apart(i + 1, i + width);
    }
  if (width != 1 && height != 1) return widest;
  for (std::size_t i = 0; i + 1 < width * height; ++i) apart(i, i + 1);
  return widest * std::numbers::sqrt2;
}

}  // namespace clearance
