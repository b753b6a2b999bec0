// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a camera does not see: behind everything that returns its light, and where nothing returns.

#include <clearance/concepts/capsule.hpp>
#include <clearance/points/masked.hpp>

namespace clearance {

/// Which room behind its pixels an image hides, in metres of z.
struct hiding {
  real nearest = 0.1f;            ///< From this depth on a pixel without a return hides everything.
  real farthest = 10;             ///< Up to this depth pixels hide. What is farther does not matter.
  bool infinite_is_free = false;  ///< A pixel of +inf says that nothing is there (REP 117); otherwise it is no return.
};

/// The hidden room of an image as a source: each pixel is the way behind its return, along its middle. Its point is
/// where that way begins. `half_pixel` is half the diagonal of a pixel at z = 1: the room around a way is so wide. The
/// bracket carries that width.
template <seeing_image Image>
struct hidden {
  static constexpr bool sight = true;
  static constexpr bool surveys =
      surveyed_source<Image> && requires(const Image i) { i.deproject(0, 0u, 0u); };  ///< See `surveyed_capsules`.
  using can = can_all<clearance::can<sources::capsules, sources::ranged, sources::rounded>,
                      can_if<surveys, sources::surveyed_around>, can_as<Image, sources::copied>>;

  Image image;
  hiding room;
  real half_pixel;
  const point_label* labels = nullptr;  ///< One per pixel, where the backend reads them, or null.
  bool own = false;                     ///< What the robot's own points hide, and not what all others do.

  CLEARANCE_HD std::size_t size() const { return image.size(); }
  CLEARANCE_HD sample operator[](std::size_t i) const {
    const sample s = image[i];
    const bool is_own = labels != nullptr && s.valid() && labels[i] == point_label::own;
    if (is_own != own) return {s.position, drop_reason::masked};
    return starting(s, i);
  }
  /// The way from `start` to where the room ends. It goes along the pixel itself, because the point may be too near the
  /// camera to tell a direction.
  CLEARANCE_HD capsule around(std::size_t i, vec3 start) const {
    return {start, scaled(max(room.farthest - start.z, 0), image.way(i)), 0};
  }
  /// See `beyond_range`: what a return hides may begin where the room ends. A pixel that is free all the way has none.
  CLEARANCE_HD real beyond(std::size_t, vec3 start) const {
    return start.z >= room.farthest ? start.z - room.farthest : infinity;
  }

  /// See `surveyed_capsules`: if every pixel hides something, and no depth is strange.
  bool survey_capsules(std::size_t begin, extent& starts, extent& ends, real& widest,
                       std::uint32_t (&)[drop_reasons]) const
    requires surveys
  {
    std::uint32_t dropped[drop_reasons] = {}, silent = 0;
    if (own || labels != nullptr) return false;
    widest = 0;
    if (!image.survey(begin, starts, dropped)) return false;
    for (const std::uint32_t n : dropped) silent += n;
    if (starts.upper.z >= room.farthest || dropped[int(drop_reason::too_close)] != 0) return false;
    if (room.infinite_is_free && dropped[int(drop_reason::not_finite)] != 0) return false;
    const std::size_t last = begin + surveyed_points - 1;
    const std::size_t first_of_row = begin / image.width * image.width, last_row = last / image.width * image.width;
    const bool one = first_of_row == last_row;
    for (const std::size_t row : {first_of_row, last_row})
      for (const std::size_t i : {one ? begin : row, one ? last : row + image.width - 1}) {
        const vec3 way = image.way(i);
        if (silent != 0) starts.add(scaled(room.nearest, way));
        ends.add(scaled(room.farthest * (1 + slack), way));
        ends.add(scaled(room.farthest * (1 - slack), way));
      }
    return true;
  }

  /// The error of the image, the pixel's width, and what rounding adds to the way.
  position_error rounding() const {
    const position_error own = rounding_of(image);
    return {own.absolute, own.relative + double(half_pixel) + 0x1p-19, own.gap};
  }

  std::span<const std::byte> bytes() const
    requires copied_source<Image>
  {
    return image.bytes();
  }
  hidden at(const std::byte* copy) const
    requires copied_source<Image>
  {
    hidden moved = *this;
    moved.image = image.at(copy);
    return moved;
  }

 private:
  CLEARANCE_HD sample starting(const sample& s, std::size_t i) const {
    if (s.valid()) return {s.position, s.position.z < room.farthest ? drop_reason::none : drop_reason::out_of_range};
    const real depth = image.depth(i);
    real z = room.nearest;
    if (s.dropped == drop_reason::too_close) z = 0;  // it hides all that is behind the lens
    if (s.dropped == drop_reason::out_of_range && depth >= 0 && depth < z) z = depth;  // something is there
    if (room.infinite_is_free && depth == infinity) z = infinity;
    if (!(z < room.farthest)) return {{0, 0, 0}, drop_reason::out_of_range};
    const vec3 way = image.way(i);
    if (!is_finite(way)) return {{0, 0, 0}, drop_reason::not_finite};
    return {scaled(z, way), drop_reason::none};
  }
};

}  // namespace clearance
