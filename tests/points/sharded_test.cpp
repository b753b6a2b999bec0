// SPDX-License-Identifier: BSD-3-Clause
// Pieces side by side make up the cloud again, and a slice needs no more bytes than its points.
#include "support/product.hpp"

#include <clearance/make_model.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/sharded.hpp>
#include <clearance/volume/sphere.hpp>

namespace sharded_test {

using namespace testing;
using clearance::first_of_piece, clearance::host, clearance::piece_of, clearance::sharded, clearance::slice;

namespace {

/// All points, through pieces that are asked for as devices would be.
template <class S>
void deal(const S& cloud, verdict& v, const std::string& what) {
  for (std::size_t n = 1; n <= 7; ++n) {
    std::vector<decltype(piece_of(cloud, 0, 1))> pieces;
    for (std::size_t k = 0; k < n; ++k) {
      const auto first = first_of_piece(cloud, k, n);
      v.require(first % 4 == 0 || first == cloud.size(), what, ": a piece cannot be read by fours");
      pieces.push_back(piece_of(cloud, k, n));
      v.require(pieces.back().size() == first_of_piece(cloud, k + 1, n) - first, what, ": a piece of another size");
      v.require(pieces.back().size() <= cloud.size() / n + 8, what, ": a piece is far too large");
    }
    const sharded whole(pieces);
    static_assert(clearance::explain_point_source<std::remove_const_t<decltype(whole)>>());
    v.require(whole.size() == cloud.size(), what, ": another size");
    for (std::size_t i = 0; i < whole.size() && i < cloud.size(); ++i) {
      const clearance::sample a = whole[i], b = cloud[i];
      v.require(a.dropped == b.dropped && (!a.valid() || same_bytes(a.position, b.position)), what, ": point ", i,
                " is another");
    }
    const auto its = clearance::rounding_of(whole), own = clearance::rounding_of(cloud);
    v.require(its.absolute == own.absolute && its.relative == own.relative, what, ": another rounding");
  }
}

/// A slice's bytes elsewhere, and nothing beside them, give the same points.
template <class S>
void copy_slices(const S& cloud, verdict& v, const std::string& what) {
  dice d(71);
  for (int k = 0; k < 60; ++k) {
    const std::size_t begin = d.below(unsigned(cloud.size()) + 1),
                      end = begin + d.below(unsigned(cloud.size() - begin) + 1);
    const auto some = slice(cloud, begin, end);
    const auto bytes = some.bytes();
    const std::vector<std::byte> copy(bytes.begin(), bytes.end());
    v.require(bytes.size() <= cloud.bytes().size(), what, ": more bytes than there are");
    const auto moved = some.at(copy.data());
    v.require(moved.size() == end - begin, what, ": a copy of another size");
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const clearance::sample a = moved[i], b = cloud[begin + i];
      v.require(a.dropped == b.dropped && (!a.valid() || same_bytes(a.position, b.position)), what, ": a copy's point ",
                i, " is another");
    }
  }
}

}  // namespace

TEST_CASE("A cloud's pieces are the cloud again, however many") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    deal(all.span, v, s.name + ", span");
    deal(all.floats, v, s.name + ", floats");
    deal(all.raw, v, s.name + ", 16-bit image");
  }
}

TEST_CASE("A slice says which bytes it needs, and needs no others") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    if (s.points.empty()) continue;
    copy_slices(all.span, v, s.name + ", span");
    copy_slices(all.floats, v, s.name + ", floats");
    copy_slices(all.doubles, v, s.name + ", doubles");
    copy_slices(all.raw, v, s.name + ", 16-bit image");
    copy_slices(all.metres, v, s.name + ", float image");
    auto rows = all.floats;  // three records a row, and padding
    rows.width = 3, rows.count = s.points.size() / 3 * 3 / 2, rows.row_step = rows.step * 3 + 11;
    if ((rows.count + 2) / 3 * rows.row_step <= s.points.size() * rows.step && rows.count > 0)
      copy_slices(rows, v, s.name + ", rows");
    auto part = all.raw;  // the left half of an image
    part.width /= 2;
    copy_slices(part, v, s.name + ", half an image");
    const std::vector<clearance::ray> rays(all.raw.size(), {0.1f, 0.2f});
    copy_slices(clearance::ray_image<std::uint16_t>(all.raw.pixels, rays.data(), all.raw.width, all.raw.height), v,
                s.name + ", rays");
  }
}

TEST_CASE("A slice of a large image needs about its share of the bytes") {
  const std::vector<std::uint16_t> depth(640 * 480, 1000);
  const clearance::depth_image<std::uint16_t> image(depth.data(), 640, 480, {525, 525, 319.5, 239.5});
  for (std::size_t k = 0; k < 4; ++k)
    CHECK(piece_of(image, k, 4).bytes().size() <= depth.size() * 2 / 4 + 2 * 1280 + 256);
  std::vector<std::byte> records(22 * 100000);
  clearance::strided_points<float> cloud;
  cloud.data = records.data(), cloud.count = 100000, cloud.step = 22;
  for (std::size_t k = 0; k < 4; ++k) CHECK(piece_of(cloud, k, 4).bytes().size() <= records.size() / 4 + 4 * 22 + 256);
}

TEST_CASE("Pieces of any size answer as one cloud; none, and too many, are refused") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const std::size_t n = s.points.size(), cuts[] = {0, n / 7, n / 7, n / 2, n};
    std::vector<clearance::point_span> pieces;
    for (int k = 0; k < 4; ++k) pieces.emplace_back(s.points.data() + cuts[k], cuts[k + 1] - cuts[k]);
    const sharded cloud(pieces);
    const auto a = clearance::ask(host{}, model, s.poses, cloud, s.cloud_pose, clearance::min_distance{});
    const auto b = clearance::ask(host{}, model, s.poses, clearance::point_span(s.points), s.cloud_pose,
                                  clearance::min_distance{});
    v.require(same_bits(a.distance, b.distance) && a.point == b.point && a.part == b.part &&
                  a.primitive == b.primitive && a.valid == b.valid,
              s.name, ": another answer");
    v.require(same_bits(a.lower, b.lower) && same_bits(a.upper, b.upper) && a.state == b.state, s.name,
              ": another bracket");
  }
  CHECK_THROWS_AS(sharded(std::vector<clearance::point_span>{}), std::invalid_argument);
  CHECK_THROWS_AS(sharded(std::vector<clearance::point_span>(17)), std::invalid_argument);
  const sharded three(std::vector<clearance::point_span>(3));
  CHECK(three.size() == 0);
  CHECK_THROWS_AS(clearance::check_pieces(three, 2), std::invalid_argument);
  CHECK_NOTHROW(clearance::check_pieces(three, 3));
  CHECK_NOTHROW(clearance::check_pieces(clearance::point_span(), 2));
}

}  // namespace sharded_test
