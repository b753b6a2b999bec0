// SPDX-License-Identifier: BSD-3-Clause
// A crop keeps the points that its boxes keep, in world coordinates, and counts the others.
#include "support/laws.hpp"

#include <clearance/frames/cropped_clouds.hpp>
#include <clearance/points/any_points.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/strided_points.hpp>

#include <variant>

namespace cropped_test {

using namespace testing;
using clearance::crop, clearance::cropped, clearance::depth_image, clearance::drop_reason, clearance::placed,
    clearance::point_span, clearance::position;

namespace {

constexpr double far = double(clearance::infinity);

/// What a crop says of a place, in double and by its own words: how far inside what counts, below 0 outside.
struct half_space {
  Eigen::Vector3d normal;
  double offset;
};
struct box_in_words {
  std::vector<half_space> faces;  // inside where every normal . p <= offset
  bool inside;

  double depth(const Eigen::Vector3d& p) const {
    double least = far;
    for (const half_space& f : faces) least = std::min(least, f.offset - f.normal.dot(p));
    return inside ? least : -least;
  }
};
struct crop_in_words {
  crop made;
  std::vector<box_in_words> boxes;

  void box(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper, const Eigen::Isometry3d& pose, bool inside) {
    inside ? made.inside(lower, upper, pose) : made.outside(lower, upper, pose);
    box_in_words words{{}, inside};
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d axis = pose.linear().col(k);
      const double at = axis.dot(pose.translation());
      if (upper[k] < far) words.faces.push_back({axis, upper[k] + at});
      if (lower[k] > -far) words.faces.push_back({-axis, -lower[k] - at});
    }
    boxes.push_back(words);
  }
  void height(double low, double high) {
    made.height(low, high);
    boxes.push_back({{{{0, 0, 1}, high}, {{0, 0, -1}, -low}}, true});
  }
  void plane(const Eigen::Vector3d& normal, double offset, double thickness) {
    made.without_plane(normal, offset, thickness);
    const Eigen::Vector3d n = normal.normalized();
    const double at = offset / normal.norm();
    boxes.push_back({{{n, at + thickness}, {-n, -(at - thickness)}}, false});
  }
  double depth(const Eigen::Vector3d& p) const {
    double least = far;
    for (const box_in_words& b : boxes) least = std::min(least, b.depth(p));
    return least;
  }
};

crop_in_words some_crop(dice& d) {
  crop_in_words c;
  const unsigned count = 1 + d.below(clearance::crop_boxes::most);
  for (unsigned k = 0; k < count; ++k) {
    const Eigen::Vector3d lower(d.uniform(-2, 0), d.uniform(-2, 0), d.uniform(-2, 0)),
        upper(d.uniform(0, 2), d.uniform(0, 2), d.below(3) == 0 ? far : d.uniform(0, 2));
    switch (d.below(4)) {
      case 0:
        c.box(2 * lower, 2 * upper, d.pose(1), true);
        break;
      case 1:
        c.box(0.4 * lower, 0.4 * upper, d.pose(1), false);
        break;
      case 2:
        c.height(d.uniform(-2, -0.5), d.uniform(0.5, 2));
        break;
      default:
        c.plane({d.uniform(-1, 1), d.uniform(-1, 1), 1}, d.uniform(-1, 1), d.uniform(0, 0.2));
    }
  }
  return c;
}

struct tally {
  std::size_t kept = 0, dropped = 0, surveyed = 0;
};

/// Every point of a cloud by itself, in fours and in tiles.
template <class S>
void check(const placed<S>& cloud, const crop_in_words& c, tally& t, verdict& v, const std::string& what) {
  const auto behind = clearance::cropped_clouds(cloud, c.made);
  const S& bare = cloud.source;
  const cropped<S>& some = behind.source;
  static_assert(clearance::explain_point_source<cropped<S>>());
  static_assert(clearance::fetched_source<S> == clearance::fetched_source<cropped<S>> &&
                clearance::surveyed_source<S> == clearance::surveyed_source<cropped<S>> &&
                clearance::image_source<S> == clearance::image_source<cropped<S>>);
  v.require(some.size() == bare.size(), what, ": another size");
  for (std::size_t i = 0; i < some.size(); ++i) {
    const clearance::sample now = some[i], was = bare[i];
    if (!was.valid()) {
      v.require(now.dropped == was.dropped, what, ": another reason for point ", i);
      continue;
    }
    v.require(same_bytes(now.position, was.position), what, ": point ", i, " is elsewhere");
    v.require(now.valid() || now.dropped == drop_reason::cropped, what, ": another reason");
    const Eigen::Vector3d p = cloud.pose * Eigen::Vector3d(was.position.x, was.position.y, was.position.z);
    const double depth = c.depth(p);
    if (std::abs(depth) > 1e-5) v.require(now.valid() == (depth > 0), what, ": point ", i, " at depth ", depth);
    const double by = double(beyond_range(some, i, was.position));
    v.require(by >= 0 && (now.valid() ? by == 0 : by <= std::max(0.0, -depth) + 1e-12), what, ": point ", i, " is ", by,
              " beyond");
    v.require(now.valid() || by >= 0.99 * -depth - 1e-4 || c.boxes.size() > 1 || c.boxes[0].inside, what, ": point ", i,
              " is ", by, " beyond, and ", -depth, " deep in what does not count");
    ++(now.valid() ? t.kept : t.dropped);
  }
  if constexpr (clearance::fetched_source<S>)
    if (some.fetches())
      for (std::size_t i = 0; i + 4 <= some.size(); i += 4) {
        clearance::vec3 at[4];
        const unsigned reasons = some.look(some.fetch(some.skip(some.seek(0), i)), i, at);
        for (unsigned j = 0; j < 4; ++j)
          v.require(
              (reasons >> 8 * j & 0xff) == unsigned(some[i + j].dropped) && same_bytes(at[j], some[i + j].position),
              what, ": point ", i + j, " of four");
      }
  if constexpr (clearance::surveyed_source<S>)
    for (std::size_t i = 0; i + clearance::surveyed_points <= some.size(); i += clearance::surveyed_points) {
      clearance::extent box;
      std::uint32_t dropped[clearance::drop_reasons] = {}, expected[clearance::drop_reasons] = {};
      const bool told = some.survey(i, box, dropped);
      t.surveyed += told;
      for (std::size_t j = i; told && j < i + clearance::surveyed_points; ++j) {
        const clearance::sample s = some[j];
        if (!s.valid()) ++expected[int(s.dropped)];
      }
      v.require(std::ranges::equal(dropped, expected), what, ": the tile from ", i, " on");
    }
}

}  // namespace

TEST_CASE("A crop keeps what its boxes keep in the world, wherever a cloud is, one by one, in fours and in tiles") {
  dice d(97);
  verdict v;
  tally t;
  for (int trial = 0; trial < 60; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    const crop_in_words c = some_crop(d);
    std::vector<vec3> points = d.points(640, trial % 3 == 0 ? 0.4 : 2);
    points[7].y = clearance::not_a_number;
    const Eigen::Isometry3d pose = d.pose(1);
    check(placed{point_span(points), pose}, c, t, v, what + ", points");
    check(placed{point_span(points, clearance::point_filter{.nearest = 0.5, .farthest = 1.5}), pose}, c, t, v,
          what + ", points in a range");
    std::vector<position> doubles;
    for (const vec3& p : points) doubles.push_back({p.x, p.y, p.z});
    clearance::strided_points<double> records;
    records.data = reinterpret_cast<const std::byte*>(doubles.data());
    records.count = doubles.size();
    records.step = sizeof(position);
    for (std::uint32_t k = 0; k < 3; ++k) records.offset[k] = 8 * k;
    check(placed{records, pose}, c, t, v, what + ", records");
    std::vector<std::uint16_t> pixels;
    for (int i = 0; i < 64 * 10; ++i)
      pixels.push_back(i % 9 == 0 ? std::uint16_t(0) : std::uint16_t(d.uniform(900, 1100)));
    const depth_image<std::uint16_t> image(pixels.data(), 64, 10, {60, 60, 31.5, 4.5});
    check(placed{image, pose}, c, t, v, what + ", an image");
    const std::vector<clearance::point_label> labels(640, clearance::point_label::own);
    check(placed{clearance::masked(point_span(points), labels.data()), pose}, c, t, v, what + ", all masked");
  }
  CHECK((t.kept > 20000 && t.dropped > 20000 && t.surveyed > 50));
}

TEST_CASE("A crop's numbers are looked at, and what is no box is refused in a sentence") {
  const auto refused = [](const auto& f, const std::string& why) {
    std::string said;
    try {
      f();
    } catch (const std::invalid_argument& error) {
      said = error.what();
    }
    INFO(said);
    CHECK(said.find("clearance: " + why) == 0);
  };
  crop c;
  refused([&] { c.inside({0, 0, 0}, {1, -1, 1}); }, "a crop's box has a lower end that is not below the upper one");
  refused([&] { c.height(far * 0, 1); }, "a crop's box has a lower end");
  refused([&] { c.without_plane({0, 0, 0}, 1, 0.1); }, "a crop's plane needs a normal that is not 0");
  refused([&] { c.without_plane({0, 0, 1}, 1, -0.1); }, "a crop's plane needs a normal");
  Eigen::Isometry3d scaled = Eigen::Isometry3d::Identity();
  scaled.linear() *= 2;
  refused([&] { c.outside({0, 0, 0}, {1, 1, 1}, scaled); }, "the pose of a crop's box is not rigid");
  CHECK(c.empty());
  for (std::uint32_t k = 0; k < clearance::crop_boxes::most; ++k) c.height(-1, 1);
  refused([&] { c.height(-1, 1); }, "a crop has more than 4 boxes");

  const std::vector<vec3> points{{0, 0, 0}};
  cropped<point_span> source(point_span(points), c.seen_from(Eigen::Isometry3d::Identity()));
  const auto good = source;
  rounding_of(source);
  source.boxes.count = 5;
  refused([&] { rounding_of(source); }, "a cloud is cropped by more than 4 boxes");
  source = good;
  source.boxes.box[1].lower.x = clearance::not_a_number;
  refused([&] { rounding_of(source); }, "a cloud is cropped by a box whose lower corner is not below its upper one");
  source = good;
  source.boxes.box[3].box_from_cloud.translation.y = clearance::infinity;
  refused([&] { rounding_of(source); }, "a cloud is cropped by a box at a place that is not finite");
}

TEST_CASE("Clouds of every kind are cropped, each where it is") {
  const std::vector<vec3> a{{0, 0, 0}, {0, 0, 2}}, b{{0, 0, 1}};
  const crop low = crop().height(-1, 1);
  const Eigen::Isometry3d up(Eigen::Translation3d(0, 0, 1));
  const auto reasons = [&](const auto& clouds) {
    std::vector<int> all;
    const auto behind = clearance::cropped_clouds(clouds, low);
    clearance::for_each_cloud(behind, [&](const auto& source, const Eigen::Isometry3d&) {
      for (std::size_t i = 0; i < source.size(); ++i) all.push_back(int(source[i].dropped));
    });
    return all;
  };
  constexpr int out = int(drop_reason::cropped);
  CHECK(reasons(a) == std::vector{0, out});
  CHECK(reasons(placed{point_span(a), up}) == std::vector{0, out});
  CHECK(reasons(std::vector{placed{point_span(a), up}, placed{point_span(b), up}}) == std::vector{0, out, out});
  CHECK(reasons(std::tuple(a, placed{point_span(b), up})) == std::vector{0, out, out});
  CHECK(reasons(std::variant<std::vector<vec3>, placed<point_span>>(placed{point_span(b), up})) == std::vector{out});
  const clearance::sharded whole(std::vector{point_span(a), point_span(b)});
  CHECK(reasons(placed{whole, up}) == std::vector{0, out, out});
  const auto behind = clearance::cropped_clouds(placed{whole, up}, low);
  CHECK((behind.source.pieces() == 2 && behind.source.piece(1)[0].dropped == drop_reason::cropped));
  const cropped<point_span> kept{point_span(a), low.seen_from(up)};
  CHECK(clearance::any_points(kept)[1].dropped == drop_reason::cropped);
}

TEST_CASE("An uncertain point counts if its ball reaches where points count, and only then") {
  dice d(13);
  verdict v;
  std::size_t kept = 0, dropped = 0;
  for (int trial = 0; trial < 40; ++trial) {
    crop_in_words c = some_crop(d);
    const std::vector<vec3> points = d.points(200, 2);
    const double shift = d.uniform(0.01, 0.3);
    const clearance::uncertain bare(point_span(points), clearance::no_noise{}, {.shift = shift});
    const placed cloud{bare, d.pose(1)};
    const auto behind = clearance::cropped_clouds(cloud, c.made);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double depth = c.depth(cloud.pose * Eigen::Vector3d(points[i].x, points[i].y, points[i].z));
      const bool counts = behind.source[i].valid();
      if (depth > -shift) v.require(counts, "point ", i, " of trial ", trial, " is lost: ", depth);
      // Where several boxes meet, or beside an edge, a ball may be farther away than each face says.
      if (c.boxes.size() == 1 && !c.boxes[0].inside && depth < -shift - 1e-4)
        v.require(!counts, "point ", i, " of trial ", trial, " counts: ", depth);
      ++(counts ? kept : dropped);
    }
  }
  CHECK((kept > 500 && dropped > 500));
}

}  // namespace cropped_test
