// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A question of one's own: for each part of a robot, how many points are nearer than some limits? It is a value, and
// has every form: asked once, prepared, enqueued and in a graph, on several GPUs, over chunks, with a deadline, on
// ranks.

#include <clearance/ground/ordered.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/query/query.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

namespace own_question {

// [question]
struct nearness {
  std::array<double, 3> limits = {0.05, 0.1, 0.2};  ///< Metres, ascending. What is asked.
  using can = clearance::can<clearance::merging, clearance::partial>;

  struct result {                          ///< What the user gets.
    std::vector<unsigned long long> near;  ///< Three per part.
    clearance::point_counts counts;
  };
  struct out {  ///< Where a backend writes it.
    unsigned long long* near;
    clearance::point_counts* counts;
  };
  /// What is kept of all pairs of a point and a part: a view of memory that the backend writes.
  struct answer {
    unsigned long long* near;
    clearance::real limits[3];

    CLEARANCE_HD clearance::real reach(std::uint32_t) const { return limits[2]; }  // farther pairs do not matter
    CLEARANCE_HD void take(const clearance::pair_distance& pair) const {           // from any thread, in any order
      for (int i = 0; i < 3; ++i)
        if (pair.distance < limits[i]) clearance::add_to(near + 3 * pair.part + i, 1);
    }
  };

  template <class Asked>
  out space(const Asked& a) const {
    return {a.template space<unsigned long long>(3 * a.parts()), a.template space<clearance::point_counts>(1)};
  }
  template <class Asked>
  answer prepare(const Asked& a, const out& to) const {
    const std::vector<unsigned long long> none(3 * a.parts());
    a.on.stage(std::span(none), to.near);
    return {to.near, {float(limits[0]), float(limits[1]), float(limits[2])}};
  }
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    return {a.copy_out(from.near, 3 * a.parts()), a.copy_out(from.counts, 1)[0]};
  }
  /// Two results about different points; without it there are no several GPUs, chunks, ranks or deadlines.
  static void merge(result& all, const result& other) {
    for (std::size_t i = 0; i < all.near.size(); ++i) all.near[i] += other.near[i];
    all.counts.add(other.counts);
  }
  /// While points are unseen there are at least so many.
  static void so_far(result&, std::uint64_t) {}
};
// [question]

inline std::vector<std::vector<clearance::inner_sphere>> links() {
  std::vector<std::vector<clearance::inner_sphere>> all(3);
  for (auto& link : all)
    for (int i = 0; i < 50; ++i) link.push_back({{0.01f * float(i), 0.02f * std::sin(0.3f * float(i)), 0}, 0.03f});
  return all;
}
inline std::vector<Eigen::Isometry3d> poses() {
  std::vector<Eigen::Isometry3d> all(3, Eigen::Isometry3d::Identity());
  for (std::size_t k = 0; k < all.size(); ++k) all[k].translation() << 0.1 * double(k), 0.25 * double(k), 0;
  return all;
}
inline std::vector<clearance::vec3> cloud() {
  std::vector<clearance::vec3> points;
  for (int i = 0; i < 20000; ++i)
    points.push_back({0.0007f * float(i % 1000), 0.05f * float(i / 1000), 0.01f * float(i % 11)});
  return points;
}

/// By definition: all points and all spheres.
inline nearness::result expected() {
  nearness::result r{std::vector<unsigned long long>(9), {}};
  const auto bodies = links();
  for (const clearance::vec3 p : cloud())
    for (std::size_t k = 0; k < 3; ++k) {
      const clearance::vec3 q = clearance::to_floats(poses()[k].inverse())(p);
      clearance::real least = clearance::infinity;
      for (const auto& s : bodies[k]) least = std::min(least, s.distance(q));
      for (std::size_t i = 0; i < 3; ++i) r.near[3 * k + i] += least < float(nearness{}.limits[i]);
    }
  r.counts.seen = r.counts.valid = cloud().size();
  return r;
}

/// 0 if it is what is expected.
inline int wrong(const char* form, const nearness::result& r) {
  static const nearness::result right = expected();
  std::printf("%-12s part 0: %llu points nearer than 5 cm, %llu than 10, %llu than 20\n", form, r.near[0], r.near[1],
              r.near[2]);
  return r.near == right.near && r.counts.valid == right.counts.valid ? 0 : 1;
}

}  // namespace own_question
