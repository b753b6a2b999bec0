// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"
#include "support/same_result.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/points/point_cloud2.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/slice.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <stdexcept>

namespace point_cloud2_test {

using namespace testing;
using clearance::point_cloud2_view, clearance::point_field;

namespace {

/// The members of sensor_msgs/PointCloud2, of the types that ROS 2 gives them.
struct message {
  struct field {
    std::string name;
    std::uint32_t offset;
    std::uint8_t datatype;
    std::uint32_t count;
  };
  std::uint32_t height, width;
  std::vector<field> fields;
  bool is_bigendian = false;
  std::uint32_t point_step, row_step;
  std::vector<std::uint8_t> data;
};

/// Points as `height` rows of a random layout, with other fields and garbage between. The bytes end with the last
/// coordinate's point, so that a sanitizer sees who reads on.
template <class Scalar>
message packed(dice& d, const std::vector<vec3>& points, std::uint32_t height, std::uint32_t padding) {
  constexpr std::uint8_t type = sizeof(Scalar) == 4 ? 7 : 8;
  message m{.height = height,
            .width = std::uint32_t(points.size()) / height,
            .fields = {},
            .point_step = 0,
            .row_step = 0,
            .data = {}};
  std::vector<std::string> order = {"x", "y", "z", "intensity", "ring"};
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[d.below(unsigned(k))]);
  std::uint32_t at[3] = {};
  for (const std::string& name : order) {
    m.point_step += d.below(4);
    if (name.size() == 1) at[name[0] - 'x'] = m.point_step;
    m.fields.push_back({name, m.point_step, name.size() == 1 ? type : std::uint8_t(4), d.below(2)});
    m.point_step += name.size() == 1 ? std::uint32_t(sizeof(Scalar)) : 2;
  }
  m.point_step += d.below(9);
  m.row_step = m.width * m.point_step + padding;
  m.data.resize(std::size_t(height - 1) * m.row_step + m.width * m.point_step, 0xcd);
  m.data.shrink_to_fit();
  for (std::uint32_t row = 0, i = 0; row < height; ++row)
    for (std::uint32_t column = 0; column < m.width; ++column, ++i) {
      const Scalar xyz[3] = {points[i].x, points[i].y, points[i].z};
      for (int k = 0; k < 3; ++k)
        std::memcpy(m.data.data() + row * m.row_step + column * m.point_step + at[k], &xyz[k], sizeof(Scalar));
    }
  return m;
}

std::vector<vec3> some_points(dice& d, std::size_t n) {
  auto all = d.points(n, 3);
  for (std::size_t k = 3; k < n; k += 11) (&all[k].x)[k % 3] = clearance::not_a_number;
  for (std::size_t k = 5; k < n; k += 13) (&all[k].x)[k % 3] = infinity;
  return all;
}

template <class Scalar>
void check_layouts(unsigned seed) {
  dice d(seed);
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(random_spheres(d, 50)));
  verdict v;
  for (int trial = 0; trial < 60; ++trial) {
    const std::uint32_t height = 1 + d.below(4), padding = height > 1 ? d.below(3) * 7 : 0;
    const auto points = some_points(d, height * (1 + d.below(80)));
    const message m = packed<Scalar>(d, points, height, padding);
    const auto view = point_cloud2_view<Scalar>(m);
    const clearance::point_span plain(points);
    v.require(view.size() == points.size(), "another size");
    v.require(view.data == reinterpret_cast<const std::byte*>(m.data.data()), "not where the message's bytes are");
    for (std::size_t i = 0; i < points.size(); ++i)
      v.require(view[i].dropped == plain[i].dropped && (!plain[i].valid() || same_bytes(view[i].position, points[i])),
                "point", i, " differs");

    // What it says that it needs is enough: the last coordinate ends there, and a copy of it alone reads the same.
    const auto bytes = view.bytes();
    v.require(bytes.data() == view.data && bytes.size() <= m.data.size(), "bytes outside the message");
    const std::vector<std::byte> copy(bytes.begin(), bytes.end());
    const std::size_t last = points.size() - 1, begin = d.below(unsigned(points.size()));
    v.require(!plain[last].valid() || same_bytes(view.at(copy.data())[last].position, points[last]), "copy of all");
    const auto some = clearance::slice(view, begin, points.size());
    const std::vector<std::byte> part_copy(some.bytes().begin(), some.bytes().end());
    for (std::size_t i = begin; i <= last; ++i)
      v.require(!plain[i].valid() || same_bytes(some.at(part_copy.data())[i - begin].position, points[i]), "a piece");

    const Eigen::Isometry3d pose = d.pose(1);
    const auto a = clearance::ask(clearance::host{}, part, pose, view, clearance::min_distance{});
    const auto b = clearance::ask(clearance::host{}, part, pose, points, clearance::min_distance{});
    v.require(same_bits(a.distance, b.distance) && a.point == b.point && a.primitive == b.primitive &&
                  a.state == b.state && a.valid == b.valid && a.seen == b.seen,
              "another answer in trial", trial);
    if constexpr (sizeof(Scalar) == 4) v.require(same_result(a, b), "another bracket in trial", trial);
  }
}

template <class F>
std::string refusal(F f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "not refused";
}

}  // namespace

TEST_CASE("A PointCloud2 of any layout gives its points, and the answer of a packed copy to the bit") {
  check_layouts<float>(1);
  check_layouts<double>(2);
}

TEST_CASE("A cloud without a message is read likewise, with a filter; an empty one has no points") {
  dice d(3);
  const auto points = some_points(d, 40);
  const point_field fields[] = {{"z", 8}, {"y", 4}, {"x", 0}};
  const auto view = point_cloud2_view(
      clearance::point_cloud2{
          .fields = fields, .width = 40, .point_step = 12, .row_step = 0, .data = std::as_bytes(std::span(points))},
      {.nearest = 2});
  const clearance::point_span plain(points, {.nearest = 2});
  for (std::size_t i = 0; i < 40; ++i) CHECK(view[i].dropped == plain[i].dropped);
  for (const std::uint32_t height : {0u, 1u, 7u}) {
    const auto none = point_cloud2_view(
        clearance::point_cloud2{.fields = fields, .height = height, .width = 0, .point_step = 12, .data = {}});
    CHECK(none.size() == 0);
    CHECK(none.bytes().empty());
  }
}

TEST_CASE("A row_step that cannot be is not read where the rows lie without gaps: 0, another cloud's, all bytes") {
  dice d(5);
  verdict v;
  for (int trial = 0; trial < 200; ++trial) {
    const std::uint32_t height = 2 + d.below(5);
    const auto points = some_points(d, height * (1 + d.below(30)));
    message m = packed<float>(d, points, height, 0);
    const std::uint32_t own = m.row_step, all = std::uint32_t(m.data.size());
    for (const std::uint32_t said : {0u, 1u, own - 1, own + 1, 2 * own, all, all + 7, 0xffffffffu}) {
      m.row_step = said;
      const auto view = point_cloud2_view(m);
      v.require(view.size() == points.size() && view.bytes().size() <= m.data.size(), "another size with", said);
      for (std::size_t i = 0; i < points.size(); ++i)
        v.require(view[i].valid() == clearance::is_finite(points[i]) &&
                      (!view[i].valid() || same_bytes(view[i].position, points[i])),
                  "point", i, " differs");
    }
  }
}

TEST_CASE("Rows of a message have the one step that fits, or none") {
  verdict v;
  for (std::uint64_t rows = 0; rows < 6; ++rows)
    for (std::uint64_t bytes = 0; bytes < 6; ++bytes)
      for (std::uint64_t held = 0; held < 40; ++held)
        for (const std::uint64_t said : {0ull, 1ull, 2ull, 3ull, 5ull, 6ull, 9ull, 30ull, ~0ull}) {
          const auto fits = [&](std::uint64_t step) {
            return rows == 0 || bytes == 0 || (step >= bytes && step < 100 && (rows - 1) * step + bytes <= held);
          };
          const auto step = clearance::row_step(rows, bytes, said, held);
          const bool tight = rows * bytes == held;
          if (rows <= 1 || bytes == 0)
            v.require(step.has_value() == fits(bytes) && step.value_or(bytes) == bytes, "one row");
          else if (fits(said))
            v.require(step == said, "what is said fits");
          else
            v.require(step.has_value() == tight && step.value_or(bytes) == bytes, "what is said does not fit");
        }
  CHECK(clearance::row_step(~0ull, ~0ull, ~0ull, 100) == std::nullopt);
}

TEST_CASE("A PointCloud2 that contradicts itself is refused in a sentence") {
  dice d(4);
  const auto points = d.points(12, 1);
  const message good{.height = 3,
                     .width = 4,
                     .fields = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}, {"rgb", 12, 6, 1}},
                     .point_step = 16,
                     .row_step = 70,
                     .data = std::vector<std::uint8_t>(2 * 70 + 64)};
  CHECK(point_cloud2_view(good).size() == 12);
  const auto says = [&](auto change) {
    message m = good;
    change(m);
    return refusal([&] { point_cloud2_view(m); });
  };
  CHECK(says([](message& m) { m.is_bigendian = true; }) == "clearance: the cloud is big-endian");
  CHECK(says([](message& m) { m.fields[1].name = "Y"; }) ==
        "clearance: the cloud has no field y (it has: x, Y, z, rgb)");
  CHECK(says([](message& m) { m.fields.clear(); }) == "clearance: the cloud has no field x (it has: none)");
  CHECK(says([](message& m) { m.fields[3].name = "z"; }) == "clearance: the cloud has two of the field z");
  CHECK(says([](message& m) { m.fields[2].datatype = 3; }) ==
        "clearance: the cloud holds its field z as INT16, not as FLOAT32");
  CHECK(says([](message& m) { m.fields[2].datatype = 0; }) ==
        "clearance: the cloud holds its field z as datatype 0, not as FLOAT32");
  CHECK(says([](message& m) { m.fields[0].datatype = 8; }) ==
        "clearance: the cloud holds its field x as FLOAT64, not as FLOAT32; point_cloud2_view<double> reads it");
  CHECK(refusal([&] { point_cloud2_view<double>(good); }) ==
        "clearance: the cloud holds its field x as FLOAT32, not as FLOAT64");
  CHECK(says([](message& m) { m.fields[0].count = 3; }) == "clearance: the cloud holds several numbers in its field x");
  CHECK(says([](message& m) { m.fields[2].offset = 13; }) ==
        "clearance: the cloud has its field z at byte 13, beyond its point_step of 16 bytes");
  CHECK(says([](message& m) { m.fields[2].offset = 0xfffffffe; }).find("at byte 4294967294, beyond") !=
        std::string::npos);
  CHECK(says([](message& m) { m.point_step = 0; }).find("beyond its point_step of 0 bytes") != std::string::npos);
  CHECK(says([](message& m) { m.row_step = 63; }) ==
        "clearance: the cloud says 3 x 4 points of 16 bytes, in rows of 63 bytes (row_step), but holds 204 bytes");
  CHECK(says([](message& m) { m.data.pop_back(); }) ==
        "clearance: the cloud says 3 x 4 points of 16 bytes, in rows of 70 bytes (row_step), but holds 203 bytes");
  CHECK(says([](message& m) { m.height = 1, m.data.resize(63); }) ==
        "clearance: the cloud says 1 x 4 points of 16 bytes, but holds 63 bytes");
  CHECK(says([](message& m) { m.height = 0xffffffff; }).find("says 4294967295 x 4 points") != std::string::npos);
  CHECK(says([](message& m) { m.height = m.width = m.row_step = m.point_step = 0xffffffff; }).find("but holds") !=
        std::string::npos);
}

}  // namespace point_cloud2_test
