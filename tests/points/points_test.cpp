// SPDX-License-Identifier: BSD-3-Clause
#include "support/laws.hpp"

#include <clearance/points/depth_image.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/sharded.hpp>
#include <clearance/points/slice.hpp>
#include <clearance/points/strided_points.hpp>

#include <limits>

namespace points_test {

using namespace testing;
using clearance::depth_image, clearance::drop_reason, clearance::point_filter, clearance::point_span,
    clearance::strided_points;

namespace {

constexpr real missing = clearance::not_a_number;

std::vector<vec3> with_holes(dice& d, std::size_t n) {
  auto all = d.points(n, 5);
  for (std::size_t k = 3; k < n; k += 11) (&all[k].x)[k % 3] = missing;
  for (std::size_t k = 5; k < n; k += 13) (&all[k].x)[k % 3] = k % 2 ? infinity : -infinity;
  for (std::size_t k = 7; k < n; k += 17) all[k] = {0, 0, 0};
  return all;
}

/// The same points as records of `step` bytes at a shifted address, with garbage between.
template <class Scalar>
struct records {
  std::vector<std::byte> memory;
  strided_points<Scalar> view;

  records(const std::vector<vec3>& points, std::uint32_t step, std::array<std::uint32_t, 3> offset, std::size_t shift,
          std::uint32_t width = 0, std::size_t padding = 0) {
    const std::size_t rows = width == 0 ? 1 : (points.size() + width - 1) / width;
    const std::size_t row_step = (width == 0 ? points.size() : width) * step + padding;
    memory.assign(shift + rows * row_step, std::byte{0xcd});
    view.data = memory.data() + shift, view.count = points.size(), view.step = step;
    std::copy(offset.begin(), offset.end(), view.offset);
    view.width = width, view.row_step = row_step;
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::byte* const record =
          memory.data() + shift + (width == 0 ? i * step : i / width * row_step + i % width * step);
      const Scalar xyz[3] = {points[i].x, points[i].y, points[i].z};
      for (int k = 0; k < 3; ++k) std::memcpy(record + offset[k], &xyz[k], sizeof(Scalar));
    }
  }
};

template <class S>
void require_same(const S& source, const std::vector<vec3>& points, point_filter filter = {}) {
  check_point_source_laws(source);
  const point_span plain(points, filter);
  verdict v;
  v.require(source.size() == points.size(), "another size");
  for (std::size_t i = 0; i < points.size(); ++i) {
    v.require(source[i].dropped == plain[i].dropped, "sample", i, " is dropped for another reason");
    v.require(!plain[i].valid() || same_bytes(source[i].position, points[i]), "sample", i, " is elsewhere");
  }
}

}  // namespace

TEST_CASE("A span gives its points as they are, and says what is no point") {
  dice d(1);
  const auto points = with_holes(d, 500);
  require_same(point_span(points), points);
  CHECK(point_span().size() == 0);
  CHECK(point_span(points)[3].dropped == drop_reason::not_finite);
  CHECK(point_span(points)[5].dropped == drop_reason::not_finite);
  CHECK(point_span(points)[7].valid());
  CHECK(point_span(points, {.zero_is_missing = true})[7].dropped == drop_reason::missing);
}

TEST_CASE("Ranges are distances from the sensor, both ends included") {
  const std::vector<vec3> points = {{1, 0, 0},  {2, 0, 0},       {3, 0, 0},    {0, 4, 0},
                                    {0, 0, -5}, {missing, 0, 0}, {1e30f, 0, 0}};
  const auto reasons = [&](point_filter filter) {
    std::string all;
    for (std::size_t i = 0; i < points.size(); ++i) all += "-nmsr"[int(point_span(points, filter)[i].dropped)];
    return all;
  };
  CHECK(reasons({}) == "-----nn");
  CHECK(reasons({.nearest = 2, .farthest = 4}) == "r---rnn");
  CHECK(reasons({.nearest = 0, .farthest = 1}) == "-rrrrnn");
  CHECK(reasons({.nearest = 3}) == "rr---nn");
  CHECK(reasons({.nearest = 1, .farthest = 2, .sensor = {3, 0, 0}}) == "--rrrnn");
}

TEST_CASE("Records of any step and any offsets read like a plain span") {
  dice d(2);
  const auto points = with_holes(d, 300);
  for (const std::uint32_t step : {12u, 16u, 18u, 22u, 32u, 48u})
    for (const std::size_t shift : {0, 1, 2, 3, 4}) {
      require_same(records<float>(points, step, {0, 4, 8}, shift).view, points);
      require_same(records<float>(points, step, {step - 4, 0, 4}, shift).view, points);
      if (step > 12) require_same(records<float>(points, step, {step - 4, step - 9, 1}, shift).view, points);
    }
}

TEST_CASE("Records of doubles, and rows with padding, read like a plain span") {
  dice d(3);
  const auto points = with_holes(d, 300);
  for (const std::uint32_t step : {24u, 26u, 32u, 41u})
    for (const std::size_t shift : {0, 3, 8})
      require_same(records<double>(points, step, {0, 8, step - 8}, shift).view, points);
  for (const std::size_t padding : {0, 5, 64}) {
    require_same(records<float>(points, 18, {0, 4, 8}, 0, 20, padding).view, points);
    require_same(records<float>(points, 12, {0, 4, 8}, 1, 7, padding).view, points);  // the last row is not full
  }
}

TEST_CASE("Doubles far from the origin keep their millimetres when an origin is subtracted") {
  const double x[3] = {5000000.125, -4500000.25, 900.0625};
  strided_points<double> source;
  source.data = reinterpret_cast<const std::byte*>(x), source.count = 1, source.step = 24;
  source.offset[1] = 8, source.offset[2] = 16;
  source.origin = {5e6f, -4.5e6f, 896};
  CHECK(source[0].position == vec3{0.125f, -0.25f, 4.0625f});
}

TEST_CASE("A filter holds for records too") {
  dice d(4);
  const auto points = with_holes(d, 300);
  records<float> r(points, 22, {1, 7, 13}, 1);
  r.view.filter = {.nearest = 2, .farthest = 6, .sensor = {1, 0, 0}, .zero_is_missing = true};
  require_same(r.view, points, r.view.filter);
}

namespace {

void require_there(vec3 p, std::uint32_t u, std::uint32_t v, wide z, const clearance::intrinsics& camera,
                   verdict& verdict) {
  const auto truth = oracle::deprojected(u, v, z, camera.fx, camera.fy, camera.cx, camera.cy);
  verdict.require(oracle::between(wider(p), truth) <= 8 * 0x1p-24L * oracle::length(truth), "pixel", u, v,
                  " is elsewhere");
}

}  // namespace

TEST_CASE("Depth images give the points that the oracle deprojects, and say what is no pixel") {
  const clearance::intrinsics camera{525.5, 520.25, 20.25, 15.75};
  dice d(5);
  constexpr std::uint32_t width = 40, height = 30, row = 44;
  std::vector<std::uint16_t> raw(row * height);
  std::vector<float> metres(row * height);
  for (std::size_t k = 0; k < raw.size(); ++k) {
    raw[k] = std::uint16_t(1 + d.below(8000));
    if (k % 7 == 0) raw[k] = 0;
    if (k % 11 == 0) raw[k] = 65535;
    metres[k] = float(raw[k]) * 0.001f;
    if (raw[k] == 65535) metres[k] = k % 2 ? missing : infinity;
    if (k % 13 == 0) metres[k] = -1;
  }
  depth_image<std::uint16_t> millimetres(raw.data(), width, height, camera);
  depth_image<float> floats(metres.data(), width, height, camera);
  millimetres.row = floats.row = row;
  check_point_source_laws(millimetres);
  check_point_source_laws(floats);
  CHECK(millimetres.size() == width * height);
  verdict v;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x, at = y * row + x;
      const auto a = millimetres[i];
      const auto expected = raw[at] == 0       ? drop_reason::missing
                            : raw[at] == 65535 ? drop_reason::saturated
                                               : drop_reason::none;
      v.require(a.dropped == expected, "pixel", i, " of 16 bits");
      if (a.valid()) require_there(a.position, x, y, wide(raw[at]) * 0.001L, camera, v);
      const auto b = floats[i];
      const float z = metres[at];
      v.require(b.dropped == (z == 0              ? drop_reason::missing
                              : !std::isfinite(z) ? drop_reason::not_finite
                              : z < 0             ? drop_reason::out_of_range
                                                  : drop_reason::none),
                "pixel", i, " of floats");
      if (b.valid()) require_there(b.position, x, y, z, camera, v);
    }
}

TEST_CASE("The range of a depth image is along z, both ends included") {
  const clearance::intrinsics camera{1, 1, 0, 0};
  const std::vector<float> z = {0.5f, 1, 2, 3, 3.5f, missing};
  depth_image<float> image(z.data(), 6, 1, camera);
  image.nearest = 1, image.farthest = 3;
  std::string reasons;
  for (std::size_t i = 0; i < 6; ++i) reasons += "-nmsr"[int(image[i].dropped)];
  CHECK(reasons == "r---rn");
  depth_image<std::uint16_t> empty(nullptr, 0, 0, camera);
  CHECK(empty.size() == 0);
  CHECK(empty.bytes().empty());
}

TEST_CASE("An image without pixels states no rounding, and changes none beside it") {
  const std::uint16_t pixels[6] = {1, 2, 3, 4, 5, 6};
  const clearance::ray rays[6] = {};
  const auto check = [](const auto& full, const auto& empty, auto no_rows) {
    no_rows.height = 0;
    const auto own = clearance::rounding_of(full);
    CHECK(own.relative > 0);
    for (const auto& none_of_it : {empty, no_rows}) {
      const auto error = clearance::rounding_of(none_of_it);
      CHECK((none_of_it.size() == 0 && error.absolute == 0 && error.relative == 0));
      for (const auto& pieces : {std::vector{none_of_it, full}, std::vector{full, none_of_it}}) {
        const auto together = clearance::rounding_of(clearance::sharded(pieces));
        CHECK((together.absolute == own.absolute && together.relative == own.relative));
      }
    }
  };
  const depth_image<std::uint16_t> image(pixels, 3, 2, {600, 600, 1, 0.5});
  check(image, depth_image<std::uint16_t>(), image);
  const clearance::ray_image<std::uint16_t> by_rays(pixels, rays, 3, 2);
  check(by_rays, clearance::ray_image<std::uint16_t>(), by_rays);
}

namespace {

template <clearance::fetched_source S>
void check_fetches(const S& source) {
  REQUIRE(source.fetches());
  verdict v;
  typename S::cursor walking = source.seek(0);
  for (std::size_t i = 0; i + 4 <= source.size(); i += 4, walking = source.skip(walking, 4))
    for (const auto& from : {source.seek(i), walking, source.skip(source.seek(0), i)}) {
      clearance::vec3 at[4];
      const unsigned reasons = source.look(source.fetch(from), i, at);
      for (int j = 0; j < 4; ++j) {
        const clearance::sample one = source[i + j];
        v.require((reasons >> 8 * j & 0xff) == unsigned(one.dropped) && same_bytes(at[j], one.position), "sample",
                  i + j, " of four differs");
      }
    }
}

}  // namespace

TEST_CASE("Four samples at once are the same four") {
  dice d(6);
  alignas(16) std::array<vec3, 256> points;
  const auto holes = with_holes(d, points.size());
  std::copy(holes.begin(), holes.end(), points.begin());
  check_fetches(point_span(points.data(), points.size()));
  check_fetches(point_span(points.data(), points.size(), {.nearest = 1, .farthest = 6, .zero_is_missing = true}));
  CHECK(!point_span(points.data() + 1, 8).fetches());
  alignas(16) std::array<std::uint16_t, 64 * 12> raw;
  alignas(16) std::array<float, 64 * 12> metres;
  for (std::size_t k = 0; k < raw.size(); ++k)
    raw[k] = std::uint16_t(d.below(65536)), metres[k] = k % 5 ? d.number(-1, 5) : missing;
  raw[5] = 0, raw[9] = 65535;
  depth_image<std::uint16_t> a(raw.data(), 64, 12, {525, 525, 30, 6});
  check_fetches(a);
  check_fetches(depth_image<float>(metres.data(), 64, 12, {525, 525, 30, 6}));
  check_fetches(clearance::slice(a, 8, 700));
  CHECK(!clearance::slice(a, 6, 700).fetches());
  check_fetches(clearance::slice(point_span(points.data(), points.size()), 12, 100));
  a.width = 60;  // rows with padding are not one array
  CHECK(!a.fetches());
  alignas(16) std::array<clearance::ray, 64 * 12> rays;
  for (auto& r : rays) r = {d.number(-1, 1), d.number(-1, 1)};
  check_fetches(clearance::ray_image<std::uint16_t>(raw.data(), rays.data(), 64, 12));
  check_fetches(clearance::ray_image<float>(metres.data(), rays.data(), 64, 12));
  CHECK(!clearance::ray_image<float>(metres.data(), rays.data() + 1, 63, 12).fetches());
  alignas(8) std::array<std::byte, 32 * 64> bytes;
  const auto put = [&](auto scalar, std::uint32_t step, std::array<std::uint32_t, 3> offset) {
    using number = decltype(scalar);
    for (std::size_t i = 0; i < bytes.size() / step; ++i)
      for (int k = 0; k < 3; ++k) {
        const number x = d.below(20) == 0 ? number(missing) : number(d.number(-9, 9));
        std::memcpy(bytes.data() + i * step + offset[k], &x, sizeof x);
      }
    return clearance::strided_points<number>{.data = bytes.data(),
                                             .count = bytes.size() / step,
                                             .step = step,
                                             .offset = {offset[0], offset[1], offset[2]},
                                             .origin = {1, 2, 3},
                                             .filter = {.nearest = 1}};
  };
  check_fetches(put(float(), 32, {0, 4, 8}));
  check_fetches(put(float(), 20, {12, 0, 8}));
  check_fetches(put(double(), 32, {8, 0, 24}));
  CHECK(!put(float(), 22, {0, 4, 8}).fetches());
}

TEST_CASE("Four at once are told holes and the largest coordinates as one by one") {
  constexpr float nan = clearance::not_a_number, inf = clearance::infinity;
  const std::array<float, 12> edges = {0,     -0.0f,         1e-38f, 5,     1e16f, 2.9e17f,
                                       1e18f, 1.0000001e18f, 2e19f,  3e38f, inf,   nan};
  alignas(16) std::array<vec3, 4> points;
  for (const float x : edges)
    for (const float y : edges)
      for (const float z : edges) {
        points = {vec3{1, 2, 3}, vec3{x, y, z}, vec3{-y, z, -x}, vec3{4, 5, 6}};
        const point_span source(points.data(), points.size());
        check_fetches(source);
      }
}

TEST_CASE("A table of a pinhole's rays is that pinhole, bit for bit; a bent ray bends its point alone") {
  dice d(7);
  const depth_image<std::uint16_t> pinhole(nullptr, 60, 12, {525, 520, 30.5, 6.25});
  std::vector<clearance::ray> rays;
  for (std::uint32_t i = 0; i < 60 * 12; ++i) {
    const vec3 at_one{(float(i % 60) - pinhole.cx) * pinhole.inverse_fx,
                      (float(i / 60) - pinhole.cy) * pinhole.inverse_fy, 1};
    rays.push_back({at_one.x, at_one.y});
  }
  std::vector<std::uint16_t> pixels(64 * 12);
  for (auto& p : pixels) p = std::uint16_t(d.below(65536));
  pixels[3] = 0, pixels[70] = 65535;
  depth_image<std::uint16_t> a = pinhole;
  clearance::ray_image<std::uint16_t> b(pixels.data(), rays.data(), 60, 12);
  a.pixels = pixels.data(), a.row = b.row = 64, a.farthest = b.farthest = 50;
  verdict v;
  const auto same = [](const clearance::sample& x, const clearance::sample& y) {
    return x.dropped == y.dropped && same_bytes(x.position, y.position);
  };
  for (std::size_t i = 0; i < a.size(); ++i) v.require(same(a[i], b[i]), "pixel", i, " differs");
  const std::vector<std::uint16_t> moved = pixels;
  v.require(same(b.at(reinterpret_cast<const std::byte*>(moved.data()))[100], a[100]), "a copy", 100, " differs");
  rays[100].x += 0.01f;
  CHECK(b[100].position.x > a[100].position.x);
  CHECK(same(a[101], b[101]));
}

TEST_CASE("The half diagonal of a pixel is known of a single row and column, too") {
  const auto rays = [](std::size_t width, std::size_t height) {
    std::vector<clearance::ray> all;
    for (std::size_t v = 0; v < height; ++v)
      for (std::size_t u = 0; u < width; ++u) all.push_back({real(u) / 100 - 0.1f, real(v) / 100 - 0.1f});
    return all;
  };
  const double expected = std::hypot(0.01, 0.01) / 2;
  for (const std::size_t width : {1, 2, 7})
    for (const std::size_t height : {1, 2, 5})
      CHECK(clearance::half_pixel_of(rays(width, height).data(), width, height) ==
            Approx(width == 1 && height == 1 ? 0.0 : expected).epsilon(1e-5));
}

}  // namespace points_test
