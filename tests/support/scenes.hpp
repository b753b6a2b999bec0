// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots near points where something may go wrong: ties, duplicates, points inside, in gaps and on surfaces, far from
// the origin, and with nothing valid at all.

#include "support/random.hpp"

#include <clearance/points/depth_image.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/strided_points.hpp>

#include <cstring>
#include <string>

namespace testing {

template <class P>
struct scene {
  std::string name;
  std::vector<std::vector<P>> parts;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<vec3> points;
  Eigen::Isometry3d cloud_pose = Eigen::Isometry3d::Identity();
  double size = 1;  ///< Of the robot; for the depth images.
};

inline Eigen::Isometry3d shifted(double x, double y, double z) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << x, y, z;
  return pose;
}

/// 200 parts of ten spheres, more than a kernel takes; without points.
inline scene<inner_sphere> many_parts(dice& d) {
  scene<inner_sphere> s;
  for (int part = 0; part < 200; ++part) {
    s.parts.emplace_back();
    for (int k = 0; k < 10; ++k) s.parts.back().push_back({d.point(0.1f), d.number(0.005, 0.02)});
    s.poses.push_back(d.pose(1));
  }
  return s;
}

/// A lattice of exact numbers, so that mirrored points are equally far to the bit.
inline std::vector<inner_sphere> lattice(const inner_sphere*) {
  std::vector<inner_sphere> all;
  for (int k = 0; k < 27; ++k) all.push_back({{real(k % 3 - 1), real(k / 3 % 3 - 1), real(k / 9 - 1)}, 0.25f});
  return all;
}
inline std::vector<triangle> lattice(const triangle*) {
  std::vector<triangle> all;
  for (int k = 0; k < 27; ++k) {
    const vec3 c{real(k % 3 - 1), real(k / 3 % 3 - 1), real(k / 9 - 1)};
    all.push_back(triangle::from(c - vec3{0.25f, 0, 0}, c + vec3{0.25f, 0, 0}, c + vec3{0, 0.25f, 0}));
  }
  return all;
}

inline vec3 on_surface(const inner_sphere& s, dice& d) { return clearance::fma(s.radius, d.direction(), s.center); }
inline vec3 on_surface(const triangle& t, dice& d) {
  const real u = d.number(0, 1), w = d.number(0, 1) * (1 - u);
  return d.below(3) == 0 ? t.b : clearance::fma(w, t.c - t.a, clearance::fma(u, t.b - t.a, t.a));
}

template <class P>
std::vector<scene<P>> scenes() {
  dice d(21);
  std::vector<scene<P>> all;
  const auto holes = [](std::vector<vec3>& points) {
    for (std::size_t k = 4; k < points.size(); k += 9)
      points[k].y = k % 2 ? clearance::not_a_number : clearance::infinity;
  };
  {
    scene<P> s{
        "around",
        {random_primitives<P>(d, 60, 0.5, 0.2), random_primitives<P>(d, 1), random_primitives<P>(d, 90, 0.3, 0.1)},
        {d.pose(1), d.pose(1), d.pose(1)},
        d.points(300, 2),
        d.pose(0.3)};
    holes(s.points);
    all.push_back(s);
  }
  {
    scene<P> s{"outside",
               {random_primitives<P>(d, 60, 0.1, 0.05), random_primitives<P>(d, 40, 0.1, 0.05)},
               {shifted(0, 0, -0.5), shifted(0.4, 0, -0.5)},
               {}};
    for (int k = 0; k < 300; ++k) s.points.push_back({d.number(-2, 2), d.number(-2, 2), d.number(0.5, 2)});
    all.push_back(s);
  }
  {  // each primitive, part and point more than once, and mirrored
    auto twice = lattice(static_cast<const P*>(nullptr));
    for (std::size_t k = 27; k-- > 0;) twice.push_back(twice[k]);
    Eigen::Isometry3d turned = shifted(0, 0, 0);
    turned.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    scene<P> s{"ties",
               {twice, twice, lattice(static_cast<const P*>(nullptr))},
               {shifted(0, 0, 0), shifted(0, 0, 0), turned},
               {}};
    for (int k = 0; k < 40; ++k) {
      const vec3 p{real(d.below(17)) / 4 - 2, real(d.below(17)) / 4 - 2, real(d.below(9)) / 4 + 1.5f};
      for (const vec3 q : {p, vec3{-p.x, p.y, p.z}, vec3{p.x, -p.y, p.z}, p, vec3{p.y, p.x, -p.z}})
        s.points.push_back(q);
    }
    all.push_back(s);
    std::reverse(s.points.begin(), s.points.end());
    s.name = "ties, reversed";
    for (vec3& p : s.points) p = {p.x / 2, p.y / 2, p.z / 4};  // among the primitives
    all.push_back(s);
  }
  {
    scene<P> s{"coincident", {std::vector<P>(50, random_primitives<P>(d, 1)[0])}, {d.pose(1)}, d.points(100, 2)};
    s.points.insert(s.points.end(), s.points.begin(), s.points.end());
    all.push_back(s);
  }
  {
    scene<P> s{"far from the origin",
               {random_primitives<P>(d, 60, 5, 2), random_primitives<P>(d, 60, 5, 2)},
               {shifted(5e6, -4.5e6, 900), shifted(5e6 + 8, -4.5e6, 900)},
               {}};
    s.size = 10;
    for (int k = 0; k < 300; ++k) s.points.push_back(d.point(30, {5e6f, -4.5e6f, 900}));
    all.push_back(s);
  }
  {
    scene<P> s{"sizes",
               {random_primitives<P>(d, 50, 1, 1e-4), random_primitives<P>(d, 30, 100, 40)},
               {d.pose(1), d.pose(100)},
               {}};
    for (const P& p : random_primitives<P>(d, 20, 1, 1e-3)) s.parts[1].push_back(p);
    for (const double half : {0.01, 1.0, 100.0, 1e4})
      for (const vec3 p : d.points(60, half)) s.points.push_back(p);
    all.push_back(s);
  }
  {
    scene<P> s{"surfaces, insides and gaps",
               {random_primitives<P>(d, 40, 0.3, 0.3), random_primitives<P>(d, 40, 0.3, 0.3)},
               {shifted(0, 0, 0), shifted(0.25, 0, 0)},
               {}};
    for (int k = 0; k < 150; ++k) {
      const P& p = s.parts[k % 2][k % 40];
      vec3 q = k % 3 == 0 ? on_surface(p, d) : p.balls()[0].center;
      if (k % 3 == 2) q = clearance::scaled(0.5f, q + s.parts[k % 2][(k + 7) % 40].balls()[0].center);
      s.points.push_back(k % 2 ? q + vec3{0.25f, 0, 0} : q);
    }
    all.push_back(s);
  }
  {
    scene<P> s{"many points",
               {random_primitives<P>(d, 30, 0.1, 0.05), random_primitives<P>(d, 10, 0.1, 0.05)},
               {shifted(0, 0, 0), shifted(0, 0, 0.3)},
               d.points(5000, 1)};
    holes(s.points);
    all.push_back(s);
  }
  {  // every distance many times, in any order for threads and samples
    scene<P> s{"many ties", {lattice(static_cast<const P*>(nullptr))}, {shifted(0, 0, 0)}, {}};
    const auto seven = d.points(7, 2);
    for (int k = 0; k < 5001; ++k) s.points.push_back(seven[(k + 3) % 7]);
    all.push_back(s);
  }
  {  // each point a little nearer than the one before, until one touches the part's own ball
    scene<P> s{"creeping nearer", {random_primitives<P>(d, 1, 1, 0.5)}, {shifted(0, 0, 0)}, {}};
    const auto balls = s.parts[0][0].balls();
    vec3 outward = balls.size() == 1
                       ? vec3{1, 0, 0}
                       : balls[0].center - clearance::scaled(0.5f, balls[1].center + balls[balls.size() - 1].center);
    outward = clearance::scaled(1 / clearance::length(outward), outward);
    for (int k = 0; k < 5001; ++k)
      s.points.push_back(clearance::fma(balls[0].radius + 1 - real(k) * 1e-5f, outward, balls[0].center));
    all.push_back(s);
  }
  for (const std::size_t n : {0, 1, 31, 33}) {
    scene<P> s{"few points", {random_primitives<P>(d, 20)}, {d.pose(1)}, d.points(n, 2)};
    if (n == 31)
      for (vec3& p : s.points) p.x = clearance::not_a_number;
    all.push_back(s);
  }
  return all;
}

/// The points of a scene as every kind of source, and depth images of its robot; owns the memory.
template <class P>
class sources {
 public:
  explicit sources(const scene<P>& s) : points_(s.points) {
    const auto fill = [&](auto& view, auto zero, std::vector<std::byte>& memory, std::uint32_t step,
                          std::uint32_t shift) {
      using scalar = decltype(zero);
      memory.assign(shift + s.points.size() * step + 1, std::byte{0xcd});
      view.data = memory.data() + shift, view.count = s.points.size(), view.step = step;
      for (int k = 0; k < 3; ++k) view.offset[k] = std::uint32_t(1 + (2 - k) * (sizeof(scalar) + 1));  // z, y, x
      for (std::size_t i = 0; i < s.points.size(); ++i) {
        const scalar xyz[3] = {s.points[i].x, s.points[i].y, s.points[i].z};
        for (int k = 0; k < 3; ++k)
          std::memcpy(memory.data() + shift + i * step + view.offset[k], &xyz[k], sizeof(scalar));
      }
    };
    span = clearance::point_span(points_);
    fill(floats, float(), float_records_, 22, 1);
    fill(doubles, double(), double_records_, 34, 3);
    dice d(unsigned(s.points.size()) + 3);
    const std::uint32_t width = s.points.empty() ? 0 : 24, height = 14;
    [[maybe_unused]] const clearance::intrinsics camera{20, 21, 11.5, 6.5};
    for (std::uint32_t k = 0; k < width * height; ++k) {
      raw_.push_back(k % 7 == 3 ? 0 : k % 11 == 5 ? 65535 : std::uint16_t(200 + d.below(3000)));
      metres_.push_back(k % 7 == 3 ? 0 : k % 11 == 5 ? clearance::not_a_number : real(raw_.back() * 0.001 * s.size));
    }
    raw = {raw_.data(), width, height, camera, 0.001 * s.size};
    metres = {metres_.data(), width, height, camera};
    metres.farthest = real(2.9 * s.size);
    // In front of the first part, looking at it.
    camera_pose = s.poses[0] * shifted(0, 0, -1.5 * s.size);
  }
  sources(const sources&) = delete;

  clearance::point_span span;
  clearance::strided_points<float> floats;
  clearance::strided_points<double> doubles;
  clearance::depth_image<std::uint16_t> raw;
  clearance::depth_image<float> metres;
  Eigen::Isometry3d camera_pose;

 private:
  std::vector<vec3> points_;
  std::vector<std::byte> float_records_, double_records_;
  std::vector<std::uint16_t> raw_;
  std::vector<float> metres_;
};

}  // namespace testing
