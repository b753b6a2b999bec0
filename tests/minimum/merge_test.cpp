// SPDX-License-Identifier: BSD-3-Clause
// Answers about pieces of a cloud, and about separate clouds, merge into the answer about all of them.
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/make_model.hpp>
#include <clearance/minimum/merge.hpp>
#include <clearance/points/slice.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace merge_test {

using namespace testing;
using clearance::host, clearance::merge, clearance::min_distance, clearance::min_distance_per_part,
    clearance::min_distance_result, clearance::part_minimum, clearance::placed, clearance::point_span,
    clearance::renumbered, clearance::slice;

namespace {

bool same_witness(const min_distance_result& a, const min_distance_result& b) {
  return same_bits(a.distance, b.distance) && a.cloud == b.cloud && a.point == b.point && a.part == b.part &&
         a.primitive == b.primitive && same_bytes(a.at, b.at) && same_bytes(a.nearest, b.nearest) &&
         same_bytes(a.normal, b.normal);
}
bool same_counts(const min_distance_result& a, const min_distance_result& b) {
  return a.seen == b.seen && a.valid == b.valid && std::ranges::equal(a.dropped, b.dropped);
}
bool same_bracket(const min_distance_result& a, const min_distance_result& b) {
  return a.state == b.state && same_bits(a.lower, b.lower) && same_bits(a.upper, b.upper);
}

/// All orders and groupings of pieces give one answer.
template <class Model, class S>
void cut(const Model& model, const std::vector<Eigen::Isometry3d>& poses, const S& source,
         const Eigen::Isometry3d& pose, dice& d, verdict& v, const std::string& what) {
  const placed whole{source, pose};
  const auto expected = ask(host{}, model, poses, whole, min_distance{});
  const auto [by_parts, own] = ask(host{}, model, poses, whole, min_distance_per_part{});
  std::vector<min_distance_result> pieces, piece_by_parts;
  std::vector<std::vector<part_minimum>> minima;
  for (std::size_t begin = 0; begin < source.size() || begin == 0;) {
    const std::size_t end = std::min(source.size(), begin + 1 + d.below(unsigned(source.size())));
    const auto piece = slice(source, begin, end);
    v.require(piece.size() == end - begin, what, ": a piece of another size");
    pieces.push_back(
        renumbered(ask(host{}, model, poses, placed{piece, pose}, min_distance{}), 0, std::uint32_t(begin)));
    auto [r, each] = ask(host{}, model, poses, placed{piece, pose}, min_distance_per_part{});
    piece_by_parts.push_back(renumbered(r, 0, std::uint32_t(begin)));
    for (auto& m : each) m = renumbered(m, 0, std::uint32_t(begin));
    minima.push_back(each);
    if (end == source.size()) break;
    begin = end;
  }
  for (int order = 0; order < 3; ++order) {
    min_distance_result all = pieces[0], parts = piece_by_parts[0];
    auto each = minima[0];
    for (std::size_t k = 1; k < pieces.size(); ++k) {
      all = order % 2 == 0 ? merge(all, pieces[k]) : merge(pieces[k], all);
      parts = order % 2 == 0 ? merge(parts, piece_by_parts[k]) : merge(piece_by_parts[k], parts);
      for (std::size_t n = 0; n < each.size(); ++n) each[n] = merge(each[n], minima[k][n]);
    }
    v.require(same_witness(all, expected), what, ": another witness");
    v.require(same_counts(all, expected), what, ": other counts");
    v.require(same_bracket(all, expected), what, ": another bracket");
    v.require(same_witness(parts, by_parts) && same_bracket(parts, by_parts) && same_counts(parts, by_parts), what,
              ": differs by parts");
    v.require(std::ranges::equal(each, own, same_minimum), what, ": some part's minimum differs");
    std::ranges::reverse(pieces), std::ranges::reverse(piece_by_parts), std::ranges::reverse(minima);
  }
}

}  // namespace

TEST_CASE("The pieces of a cloud of any kind have its answer together, in any order") {
  verdict v;
  dice d(61);
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    for (int k = 0; k < 3; ++k) {
      cut(model, s.poses, all.span, s.cloud_pose, d, v, s.name + ", span");
      cut(model, s.poses, all.doubles, s.cloud_pose, d, v, s.name + ", doubles");
      cut(model, s.poses, all.raw, all.camera_pose, d, v, s.name + ", 16-bit image");
      cut(model, s.poses, all.metres, all.camera_pose, d, v, s.name + ", float image");
    }
  }
}

TEST_CASE("Answers about several clouds have the witness and counts of one call, and a bracket that is no wider") {
  verdict v;
  for (const auto& s : scenes<triangle>()) {
    const sources<triangle> all(s);
    const auto model = make_model<clearance::aabb>(s, {}, clearance::wrapped{});
    const placed first{all.span, s.cloud_pose};
    const placed second{all.raw, all.camera_pose};
    const auto expected = ask(host{}, model, s.poses, std::tuple(first, second), min_distance{});
    const auto a = ask(host{}, model, s.poses, first, min_distance{}),
               b = renumbered(ask(host{}, model, s.poses, second, min_distance{}), 1);
    for (const auto& r : {merge(a, b), merge(b, a)}) {
      v.require(same_witness(r, expected) && same_counts(r, expected), s.name, ": another witness");
      v.require(r.lower >= expected.lower && r.upper <= expected.upper, s.name, ": a wider bracket");
      v.require(r.state == expected.state ||
                    (expected.state == clearance::state::possible && r.state == clearance::state::free),
                s.name, ": another state");
    }
  }
}

TEST_CASE("Some point certainly inside is a collision of all, and no valid point is nothing to merge") {
  const std::vector<inner_sphere> one = {{{0, 0, 0}, 1}};
  const auto model = clearance::make_model<clearance::sphere>(std::vector<std::vector<inner_sphere>>{one});
  const std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};
  const std::vector<vec3> inside = {{0.1f, 0, 0}}, apart = {{3, 0, 0}}, none = {{clearance::not_a_number, 0, 0}};
  const auto ask = [&](const std::vector<vec3>& points) {
    return clearance::ask(host{}, model, poses, points, min_distance{});
  };
  const auto hit = merge(ask(apart), renumbered(ask(inside), 1));
  CHECK((hit.state == clearance::state::collision && hit.upper == 0 && hit.lower == 0 && hit.cloud == 1 &&
         hit.valid == 2));
  for (const auto& r : {merge(ask(apart), ask(none)), merge(ask(none), ask(apart))}) {
    CHECK((r.state == clearance::state::free && r.distance == 2 && r.lower > 1.99f && r.seen == 2 && r.valid == 1));
    CHECK(r.dropped[int(clearance::drop_reason::not_finite)] == 1);
  }
  CHECK(merge(ask(none), ask(none)).state == clearance::state::no_data);
  // A pose on a device that was none leaves nothing known, whatever else was seen.
  min_distance_result lost;
  lost.state = clearance::state::possible;
  for (const auto& r : {merge(ask(apart), lost), merge(lost, ask(apart)), merge(lost, ask(none))})
    CHECK((r.state == clearance::state::possible && r.lower == 0));
}

}  // namespace merge_test
