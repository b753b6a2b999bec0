// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The answer without a tree, a bound or a thread: one obvious loop over clouds, points, parts and primitives. It uses
// the library's leaf formulas and float transforms, so that equal means equal bits; the oracle checks those.

#include "support/laws.hpp"

#include <clearance/questions/min_distance.hpp>

namespace testing {

using clearance::none;

struct brute_cloud {
  std::vector<clearance::sample> samples;
  Eigen::Isometry3d pose;

  template <clearance::point_source S>
  explicit brute_cloud(const S& source, const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) : pose(pose) {
    for (std::size_t i = 0; i < source.size(); ++i) samples.push_back(source[i]);
  }
};

template <clearance::primitive P, class Interior = clearance::no_interior>
struct brute_part {
  std::vector<P> primitives;
  clearance::part_facts facts;
  Interior interior = {};
};

struct brute_answer {
  clearance::part_minimum best;
  std::uint32_t part = none;
  std::uint64_t seen = 0, valid = 0, dropped[clearance::drop_reasons] = {};
  std::vector<clearance::part_minimum> minima;
};

template <class P, class Interior>
brute_answer brute_force(const std::vector<brute_part<P, Interior>>& parts, const std::vector<Eigen::Isometry3d>& poses,
                         const std::vector<brute_cloud>& clouds) {
  brute_answer a;
  a.minima.resize(parts.size());
  std::vector<clearance::part_facts> facts;
  for (const auto& p : parts) facts.push_back(p.facts);
  for (std::uint32_t c = 0; c < clouds.size(); ++c) {
    const clearance::frames::cloud_frame frame(facts, poses, clearance::rigid(clouds[c].pose));
    for (std::uint32_t i = 0; i < clouds[c].samples.size(); ++i) {
      const clearance::sample& s = clouds[c].samples[i];
      ++a.seen;
      if (!s.valid()) {
        ++a.dropped[int(s.dropped)];
        continue;
      }
      ++a.valid;
      for (std::uint32_t k = 0; k < parts.size(); ++k) {
        const vec3 q = frame.places[k].part_from_cloud(s.position - frame.origin);
        clearance::part_minimum here{infinity, c, i, none};
        for (std::uint32_t id = 0; id < parts[k].primitives.size(); ++id) {
          const real distance = parts[k].primitives[id].distance(q);
          if (distance < here.distance) here.distance = distance, here.primitive = id;
        }
        if (parts[k].interior.inside(q)) here.distance = 0;
        if (here.distance < a.minima[k].distance) a.minima[k] = here;
        if (here.distance < a.best.distance) a.best = here, a.part = k;
      }
    }
  }
  return a;
}

/// Compares the distance by its bits, all numbers of the witness, and the counts.
inline void require_equal(const clearance::min_distance_result& r, const brute_answer& a, verdict& v,
                          const std::string& what) {
  v.require(
      r.seen == a.seen && r.valid == a.valid && std::equal(r.dropped, r.dropped + clearance::drop_reasons, a.dropped),
      "the counts of ", what);
  if (a.part == none) {
    v.require(r.state == clearance::state::no_data && r.distance != r.distance && r.lower == 0 && r.upper == infinity &&
                  r.point == none && r.part == none && r.primitive == none && r.cloud == none,
              "no data of ", what);
    return;
  }
  v.require(same_bits(r.distance, a.best.distance), what, ": distance", r.distance, " instead of", a.best.distance);
  v.require(r.cloud == a.best.cloud && r.point == a.best.point && r.part == a.part && r.primitive == a.best.primitive,
            what, ": witness", r.cloud, ",", r.point, ",", r.part, ",", r.primitive, " instead of", a.best.cloud, ",",
            a.best.point, ",", a.part, ",", a.best.primitive);
  v.require(r.lower <= r.upper && r.lower >= 0, what, ": the bracket is empty or negative");
}

inline void require_equal(const std::vector<clearance::part_minimum>& minima, const brute_answer& a, verdict& v,
                          const std::string& what) {
  v.require(minima.size() == a.minima.size(), what, ": another number of minima");
  for (std::size_t k = 0; k < minima.size() && k < a.minima.size(); ++k) {
    const auto &got = minima[k], &expected = a.minima[k];
    v.require(same_bits(got.distance, expected.distance) && got.cloud == expected.cloud &&
                  got.point == expected.point && got.primitive == expected.primitive,
              what, ": part", k, " has", got.distance, " at", got.point, ",", got.primitive, " instead of",
              expected.distance, " at", expected.point, ",", expected.primitive);
  }
}

}  // namespace testing
