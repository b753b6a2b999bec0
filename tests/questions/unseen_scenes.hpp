// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots before small depth images with every kind of pixel.

#include "solid/shapes.hpp"
#include "support/brute_unseen.hpp"
#include "support/laws.hpp"
#include "support/same_result.hpp"

#include <clearance/make_model.hpp>
#include <clearance/seen_and_unseen.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

#include <functional>

namespace testing {

using clearance::hiding, clearance::placed, clearance::point_label;

/// A camera's picture, whose pixels lie `row` apart, and whose points of the robot are labelled.
template <class Pixel>
struct picture {
  static constexpr bool sixteen_bits = std::is_same_v<Pixel, std::uint16_t>;

  std::uint32_t width, height, row;
  clearance::intrinsics camera;
  double scale;
  pixel_rule rule;
  std::vector<Pixel> pixels;
  std::vector<point_label> labels;
  Eigen::Isometry3d pose;

  /// `strange`: which share of the pixels is no depth. `size`: of the room, metres.
  picture(dice& d, double strange, double size) {
    width = 1 + d.below(9), height = 1 + d.below(7), row = width + (d.below(3) == 0 ? 5 : 0);
    camera = {d.uniform(3, 40), d.uniform(3, 40), d.uniform(-0.2, 1.2) * width, d.uniform(-0.2, 1.2) * height};
    scale = double(real(sixteen_bits ? 0.001 : d.below(4) == 0 ? 0.1 : 1));
    if (d.below(4) == 0) rule.nearest = double(d.number(0, 0.3 * size));
    if (d.below(4) == 0) rule.farthest = double(d.number(0.3 * size, size));
    rule.minus_infinity_is_near = d.below(4) != 0;
    const double middle = d.uniform(0.1, size), spread = d.uniform(0, 0.5) * middle;
    for (std::uint32_t i = 0; i < row * height; ++i) {
      const double z = d.below(10) == 0 ? d.uniform(0, 2 * size) : middle + d.uniform(-spread, spread);
      pixels.push_back(d.uniform(0, 1) < strange ? odd(d) : Pixel(z / scale));
    }
    for (std::uint32_t i = 0; i < width * height; ++i)
      labels.push_back(d.below(5) == 0 ? point_label(d.below(4)) : point_label::rest);
    pose = d.pose(0.5);
  }

  auto image() const {
    clearance::depth_image<Pixel> all(pixels.data(), width, height, camera, scale);
    all.row = row, all.nearest = real(rule.nearest), all.farthest = real(rule.farthest);
    all.minus_infinity_is_near = rule.minus_infinity_is_near;
    return all;
  }
  auto masked_image() const { return clearance::masked{image(), labels.data()}; }
  std::vector<clearance::ray> rays() const {
    std::vector<clearance::ray> all;
    for (std::uint32_t i = 0; i < width * height; ++i)
      all.push_back({real((i % width - camera.cx) / camera.fx), real((i / width - camera.cy) / camera.fy)});
    return all;
  }
  double half_pixel() const { return std::hypot(1 / camera.fx, 1 / camera.fy) / 2; }

  std::optional<double> hides_from(std::uint32_t i, const hiding& room, bool with_labels, bool own_shadow) const {
    pixel_rule its = rule;
    its.room = room;
    return its.hides_from(double(pixels[i / width * row + i % width]), scale, sixteen_bits,
                          with_labels && labels[i] == point_label::own, own_shadow);
  }
  pyramid room_of(std::uint32_t i, double from, double to) const {
    const double u = i % width, v = i / width;
    return {(u - 0.5 - camera.cx) / camera.fx,
            (u + 0.5 - camera.cx) / camera.fx,
            (v - 0.5 - camera.cy) / camera.fy,
            (v + 0.5 - camera.cy) / camera.fy,
            from,
            to};
  }
  std::vector<pyramid> hidden(const hiding& room, bool with_labels, bool own_shadow = false) const {
    std::vector<pyramid> all;
    for (std::uint32_t i = 0; i < width * height; ++i)
      if (const auto from = hides_from(i, room, with_labels, own_shadow))
        all.push_back(room_of(i, *from, room.farthest));
    return all;
  }

 private:
  static Pixel odd(dice& d) {
    if constexpr (sixteen_bits) {
      return std::array<Pixel, 4>{0, 65535, 65534, 1}[d.below(4)];
    } else {
      constexpr float far = 1e17f, tiny = std::numeric_limits<float>::denorm_min();
      return std::array<float, 12>{
          0,      -0.0f, clearance::not_a_number, clearance::infinity, -clearance::infinity, -1, 1e-3f, 1000, far, tiny,
          1e-30f, -far}[d.below(12)];
    }
  }
};

inline hiding some_room(dice& d, double size) {
  const real nearest = d.number(0.01, 0.2) * real(size);
  return {nearest, nearest + d.number(0.3, 1.5) * real(size), d.below(2) == 0};
}

/// Parts in front of a camera, of which some primitives have no area.
template <class P>
struct seen_robot {
  std::vector<std::vector<P>> parts;
  std::vector<Eigen::Isometry3d> poses;

  seen_robot(dice& d, const Eigen::Isometry3d& camera, double size) {
    for (unsigned k = 1 + d.below(3); k-- > 0;) {
      parts.push_back(random_primitives<P>(d, 1 + d.below(25), 0.15, 0.08));
      if constexpr (std::is_same_v<P, triangle>)
        for (auto& t : parts.back())
          if (d.below(8) == 0) t = triangle::from(t.a, d.below(2) == 0 ? t.a : t.b, t.b);
      Eigen::Isometry3d there = d.pose(0);
      const double x = d.uniform(-1, 1), y = d.uniform(-1, 1), z = d.uniform(-0.3, 1.5);
      there.translation() << 0.5 * size * x, 0.5 * size * y, size * z;
      poses.push_back(camera * there);
    }
  }
  template <class V>
  auto model(std::uint32_t width) const {
    std::vector<clearance::part<clearance::bvh<V, P>>> all;
    for (const auto& its : parts)
      all.push_back(
          clearance::make_part(clearance::build<V>(its, {.width = width, .leaf_size = width == 4 ? 1u : 3u})));
    return clearance::model(std::move(all));
  }
};

/// The true distance of a part to rooms of a camera; infinite without any, negative in a sphere.
template <class P>
double to_rooms(const std::vector<P>& part, const Eigen::Isometry3d& pose, const std::vector<pyramid>& rooms,
                const Eigen::Isometry3d& camera) {
  const Eigen::Isometry3d to = camera.inverse() * pose;
  double least = clearance::infinity;
  for (const auto& room : rooms)
    for (const P& p : part) least = std::min(least, to_pyramid(p, to, room));
  return least;
}

inline bool same_unseen(const clearance::unseen_result& a, const clearance::unseen_result& b) {
  const auto same_part = [](const clearance::unseen_part& x, const clearance::unseen_part& y) {
    return same_witness(x, y) && same_bits(x.lower, y.lower) && same_bits(x.out_of_view, y.out_of_view);
  };
  return same_result(a.all, b.all) && same_result(a.own_shadow, b.own_shadow) &&
         std::ranges::equal(a.parts, b.parts, same_part);
}

/// What a call is refused with, or "".
inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

/// Asks both at once in frame after frame, with labels and without: the bits are those of each question alone on a
/// host.
template <class On>
void check_seen_and_unseen(const On& on, unsigned seed) {
  using clearance::host;
  verdict v;
  dice d(seed);
  std::size_t seen = 0, masked = 0;
  for (int n = 0; n < 12; ++n) {
    const picture<std::uint16_t> first(d, 0.2, 1.5), second(d, 0.1, 1.5);
    const seen_robot<inner_sphere> robot(d, first.pose, 1.5);
    const auto model = robot.model<clearance::sphere>(8);
    const auto there = model.on(on);
    clearance::query both(on, there, clearance::seen_and_unseen{});
    for (int frame = 0; frame < 4; ++frame) {
      const std::string what = "robot " + std::to_string(n) + ", frame " + std::to_string(frame);
      std::vector<placed<clearance::depth_image<std::uint16_t>>> images{{first.image(), d.pose(0.1) * first.pose}};
      std::vector<point_label> labels = first.labels;
      if (d.below(2) == 0)
        images.push_back({second.image(), second.pose}),
            labels.insert(labels.end(), second.labels.begin(), second.labels.end());
      clearance::seen_and_unseen q{{some_room(d, 1.5)}};
      if (frame % 2 == 1) q.labels = labels;
      const auto& found = frame == 2 ? ask(on, there, robot.poses, images, q) : both(robot.poses, images, q);
      const auto shown = q.labels.empty()
                             ? ask(host{}, model, robot.poses, images, clearance::min_distance{})
                             : ask(host{}, model, robot.poses, clearance::masked_clouds(images, labels.data()),
                                   clearance::min_distance{});
      v.require(same_result(found.seen, shown), what, ": seen");
      v.require(same_unseen(found, ask(host{}, model, robot.poses, images, static_cast<const clearance::unseen&>(q))),
                what, ": unseen");
      seen += found.seen.part != clearance::none;
      masked += found.seen.dropped[int(clearance::drop_reason::masked)];
      labels.push_back({}), q.labels = labels;
      v.require(refusal([&] { both(robot.poses, images, q); }).find("labels, and there are") != std::string::npos, what,
                ": too many labels");
    }
  }
  CHECK((seen > 10 && masked > 5));
}

}  // namespace testing
