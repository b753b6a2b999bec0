// SPDX-License-Identifier: BSD-3-Clause
// Arrays of any library are clouds as they stand: whose elements have x, y and z, or three of floats. Here are arrays
// of the test's own and, where there is CUDA, Thrust's in host memory; thrust_test.cu has those of a device.
#include "support/laws.hpp"
#include "support/same_result.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/points/arrays.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/volume/sphere.hpp>

#include <list>
#include <optional>

#if __has_include(<thrust/host_vector.h>)
#include <thrust/host_vector.h>
#include <thrust/iterator/zip_iterator.h>
#endif

namespace arrays_test {

using namespace testing;
using clearance::point_span, clearance::strided_points, clearance::coordinate_arrays, clearance::in_device_memory,
    clearance::placed, clearance::points_of, clearance::points_in, clearance::host, clearance::ask;

namespace {

struct tight {
  float x, y, z;
};
struct alignas(16) padded {
  float x, y, z, w;
};
struct doubles {
  double x, y, z;
};
struct turned {
  char tag;
  float z, y, x;
};
struct pcl_like : padded {
  pcl_like() : padded{0, 0, 0, 1} {}
};
struct mixed {
  float x, y;
  double z;
};
struct counted_in_millimetres {
  int x, y, z;
};

/// A pointer into memory that a host cannot read, as Thrust's: what it gives is no reference.
template <class T>
struct far_pointer {
  T* there;
  T* get() const { return there; }
  std::optional<T> operator*() const;
  far_pointer operator+(std::size_t n) const { return {there + n}; }
};
/// An iterator over that, as Thrust's; and one that goes backwards.
template <class P, int Step = 1>
struct adapted {
  P its;
  P base() const { return its; }
  decltype(*std::declval<const P&>()) operator*() const { return *its; }
  adapted operator+(std::size_t n) const { return {its + std::ptrdiff_t(n) * Step}; }
};
template <class P>
struct zip_of {
  std::tuple<P, P, P> all;
  const std::tuple<P, P, P>& get_iterator_tuple() const { return all; }
};
template <class T>
struct far_vector {
  std::vector<T> its;
  std::size_t size() const { return its.size(); }
  far_pointer<const T> data() const { return {its.data()}; }
};

template <class T, class S>
constexpr bool becomes = std::is_same_v<points_in<T>, S>;
static_assert(becomes<std::vector<vec3>, point_span> && becomes<std::array<tight, 3>, point_span>);
static_assert(becomes<std::span<const tight>, point_span> && becomes<tight[3], point_span>);
static_assert(becomes<std::vector<padded>, strided_points<float>> &&
              becomes<std::vector<doubles>, strided_points<double>>);
static_assert(becomes<std::vector<turned>, strided_points<float>> &&
              becomes<std::vector<pcl_like>, strided_points<float>>);
static_assert(becomes<far_vector<tight>, in_device_memory<point_span>>);
static_assert(becomes<far_vector<doubles>, in_device_memory<strided_points<double>>>);
template <class T>
constexpr bool is_none = !clearance::point_container<T>;
static_assert(is_none<std::vector<mixed>> && is_none<std::vector<counted_in_millimetres>> &&
              is_none<std::vector<float>>);
static_assert(is_none<std::list<tight>> && is_none<std::vector<Eigen::Vector3f>> && is_none<far_vector<float>>);
static_assert(is_none<point_span> && is_none<std::vector<point_span>> && is_none<tight*>);

/// Pointers and iterators, which come with a count.
template <class P>
concept counted = requires(const P& p) { points_of(p, std::size_t(3)); };
static_assert(counted<tight*> && counted<std::vector<padded>::const_iterator> && counted<far_pointer<tight>>);
static_assert(counted<adapted<far_pointer<tight>>> && counted<zip_of<float*>> && counted<zip_of<far_pointer<float>>>);
static_assert(!counted<float*> && !counted<std::list<tight>::iterator> && !counted<zip_of<int*>>);
static_assert(!counted<zip_of<std::list<float>::iterator>>);

/// What outlives the statement takes no array that ends with it.
template <class C>
concept viewed = requires(C&& c) { points_of(static_cast<C&&>(c)); };
template <class C>
concept put = requires(C&& c) { placed{static_cast<C&&>(c), Eigen::Isometry3d::Identity()}; };
template <class C>
concept in_chunks = requires(C&& c) { clearance::chunked(static_cast<C&&>(c)); };
template <class C>
concept hidden = requires(C&& c, const clearance::point_label* l) { masked_clouds(static_cast<C&&>(c), l); };
template <class C>
constexpr bool by_name = viewed<C&> && put<const C&> && in_chunks<C&> && hidden<C&> && !viewed<C> && !put<C> &&
                         !put<const C> && !in_chunks<C> && !hidden<C>;
static_assert(by_name<std::vector<vec3>> && by_name<std::vector<padded>> && by_name<far_vector<tight>>);
static_assert(viewed<std::span<tight>> && put<std::span<tight>> && in_chunks<std::span<tight>> &&
              hidden<std::span<tight>>);
static_assert(!hidden<std::tuple<far_vector<tight>>> && !hidden<std::vector<far_vector<tight>>>);

/// That points are in a device's memory is known of whatever views them.
template <class T>
constexpr bool known_of = clearance::detail::some_on_device<T>;
using far_span = in_device_memory<point_span>;
static_assert(known_of<far_vector<tight>> && known_of<std::vector<far_vector<tight>>> && known_of<far_span>);
static_assert(known_of<std::tuple<point_span, placed<far_span>>> && known_of<std::variant<point_span, far_span>>);
static_assert(known_of<clearance::masked<far_span>> && known_of<std::vector<clearance::sharded<far_span>>>);
static_assert(known_of<clearance::uncertain<far_span>> && known_of<clearance::in_memory<far_span>>);
static_assert(known_of<decltype(clearance::slice(std::declval<far_span>(), 0, 1))>);
static_assert(known_of<decltype(clearance::slice(std::declval<in_device_memory<strided_points<>>>(), 0, 1))>);
static_assert(!known_of<std::vector<vec3>> && !known_of<std::tuple<point_span, placed<point_span>>>);

struct given {
  dice d{41};
  std::vector<vec3> points = d.points(3000, 2);
  Eigen::Isometry3d pose = d.pose(0.3);
  std::vector<Eigen::Isometry3d> poses{d.pose(0.5), d.pose(0.5)};
  std::vector<std::vector<inner_sphere>> links{random_spheres(d, 30), random_spheres(d, 30)};
  decltype(clearance::make_model<clearance::sphere>(links)) robot = clearance::make_model<clearance::sphere>(links);

  given() {
    for (std::size_t k = 3; k < points.size(); k += 11) (&points[k].x)[k % 3] = clearance::not_a_number;
  }
  template <class T>
  std::vector<T> as() const {
    std::vector<T> all(points.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k].x = points[k].x, all[k].y = points[k].y, all[k].z = points[k].z;
    return all;
  }
  std::vector<real> column(int k) const {
    std::vector<real> all;
    for (const vec3& p : points) all.push_back((&p.x)[k]);
    return all;
  }

  /// All points of a source, and the answers in every form, are those of a point_span.
  template <class Cloud>
  void check(verdict& v, const Cloud& cloud, const char* what, bool exact = true) const {
    const point_span plain(points);
    const auto same = [&](const auto& a, const auto& b) {
      return exact ? same_result(a, b) : same_bits(a.distance, b.distance) && a.point == b.point;
    };
    const auto expected = ask(host{}, robot, poses, plain, clearance::min_distance{});
    const auto expected_there = ask(host{}, robot, poses, plain, pose, clearance::min_distance{});
    const auto once = [&](const auto& clouds) { return ask(host{}, robot, poses, clouds, clearance::min_distance{}); };
    v.require(same(once(cloud), expected), what, ": once");
    v.require(same(ask(host{}, robot, poses, cloud, pose, clearance::min_distance{}), expected_there), what,
              ": placed");
    v.require(same(once(placed{cloud, pose}), expected_there), what, ": in a placed cloud");
    v.require(same(once(std::vector{placed{cloud, pose}, placed{cloud}}),
                   once(std::vector{placed{plain, pose}, placed{plain}})),
              what, ": twice");
    v.require(same(once(std::tuple(point_span(points.data(), 0), cloud)),
                   once(std::tuple(point_span(points.data(), 0), plain))),
              what, ": in a tuple");
    clearance::query prepared(host{}, robot, clearance::distances{});
    v.require(std::ranges::equal(prepared(poses, cloud).distance,
                                 ask(host{}, robot, poses, plain, clearance::distances{}).distance, same_bits),
              what, ": prepared");
    clearance::min_distance_result enqueued;
    clearance::enqueue(host{}, robot, poses, cloud, clearance::min_distance{}, &enqueued);
    v.require(same(enqueued, expected), what, ": enqueued");
    v.require(
        same(ask_by(host{}, robot, poses, cloud, std::chrono::hours(1), clearance::min_distance{}).result, expected),
        what, ": by a deadline");
    clearance::chunked chunks(cloud, 1000);
    clearance::chunked_query by_chunks(host{}, robot, clearance::min_distance{});
    v.require(same(by_chunks(poses, chunks), expected), what, ": in chunks");
    const std::vector labels(points.size(), clearance::point_label::rest);
    v.require(same(once(masked_clouds(cloud, labels.data())), expected), what, ": behind a mask");
  }
};

}  // namespace

TEST_CASE("Arrays of any library are asked as they stand, with the bits of a span") {
  const given g;
  verdict v;
  g.check(v, g.points, "vec3");
  g.check(v, g.as<tight>(), "three floats");
  g.check(v, g.as<padded>(), "four floats");
  g.check(v, g.as<turned>(), "records");
  g.check(v, g.as<pcl_like>(), "points as PCL's");
  g.check(v, g.as<doubles>(), "doubles", false);
  const auto floats = g.as<tight>();
  g.check(v, std::span(floats), "a span");
  g.check(v, points_of(floats.begin(), floats.size()), "an iterator");
  const auto x = g.column(0), y = g.column(1), z = g.column(2);
  g.check(v, points_of(zip_of<const float*>{{x.data(), y.data(), z.data()}}, x.size()), "a zip");
#if __has_include(<thrust/host_vector.h>)
  g.check(v, thrust::host_vector<tight>(floats.begin(), floats.end()), "thrust::host_vector");
  const auto records = g.as<padded>();
  g.check(v, thrust::host_vector<padded>(records.begin(), records.end()), "thrust::host_vector of four floats");
  const thrust::host_vector<float> a(x.begin(), x.end()), b(y.begin(), y.end()), c(z.begin(), z.end());
  g.check(v, points_of(thrust::make_zip_iterator(a.begin(), b.begin(), c.begin()), a.size()), "Thrust's zip");
#endif
}

TEST_CASE("An empty array is a cloud without points") {
  const given g;
  for (const auto& none : {ask(host{}, g.robot, g.poses, std::vector<padded>(), clearance::min_distance{}),
                           ask(host{}, g.robot, g.poses, points_of(zip_of<float*>{}, 0), clearance::min_distance{})})
    CHECK((none.state == clearance::state::no_data && none.seen == 0));
}

TEST_CASE("Points in three arrays are read like a span, also four at once, filtered and in slices") {
  const given g;
  const std::size_t n = g.points.size();
  alignas(16) static real column[3][3000];
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < 3; ++k) column[k][i] = (&g.points[i].x)[k];
  coordinate_arrays arrays{column[0], column[1], column[2], n};
  verdict v;
  for (const clearance::point_filter filter : {clearance::point_filter{}, {.nearest = 1, .farthest = 2}}) {
    const point_span plain(g.points, filter);
    arrays.filter = filter;
    REQUIRE(arrays.fetches());
    for (std::size_t i = 0; i < n; ++i)
      v.require(arrays[i].dropped == plain[i].dropped && same_bytes(arrays[i].position, plain[i].position), "point", i);
    const coordinate_arrays slice = arrays.slice(8, 2000);
    CHECK((slice.size() == 1992 && slice.fetches() && !arrays.slice(1, 9).fetches()));
    auto walking = slice.seek(0);
    for (std::size_t i = 0; i < slice.size(); i += 4, walking = slice.skip(walking, 4)) {
      vec3 at[4];
      const unsigned reasons = slice.look(slice.fetch(walking), i, at);
      for (int j = 0; j < 4; ++j)
        v.require((reasons >> 8 * j & 0xff) == unsigned(plain[8 + i + j].dropped) &&
                      same_bytes(at[j], plain[8 + i + j].position),
                  "point", i + j, "of four");
    }
  }
  std::vector<std::vector<real>> copies;
  const coordinate_arrays there = arrays.with_pieces([&](const auto& its) {
    const auto* const from = reinterpret_cast<const real*>(its.bytes().data());
    copies.emplace_back(from, from + its.size());
    return its.at(reinterpret_cast<const std::byte*>(copies.back().data()));
  });
  CHECK((copies.size() == 3 && there.z == copies[2].data() && same_bytes(there[17].position, arrays[17].position)));
  for (const real* coordinate_arrays::* missing :
       {&coordinate_arrays::x, &coordinate_arrays::y, &coordinate_arrays::z}) {
    coordinate_arrays wrong = arrays;
    wrong.*missing = nullptr;
    CHECK_THROWS_AS(ask(host{}, g.robot, g.poses, wrong, clearance::min_distance{}), std::invalid_argument);
  }
}

TEST_CASE("What is in a device's memory can be copied to another device, whatever views it") {
  const given g;
  const auto x = g.column(0), y = g.column(1), z = g.column(2);
  const zip_of<far_pointer<const float>> zip{{{x.data()}, {y.data()}, {z.data()}}};
  const auto pieces = [](const auto& source) {
    std::vector<std::vector<std::byte>> copies;
    const auto there = clearance::frames::over_copies(source, [&](std::span<const std::byte> bytes, std::uint32_t) {
      return copies.emplace_back(bytes.begin(), bytes.end()).data();
    });
    static_assert(std::is_same_v<decltype(there), const std::remove_cvref_t<decltype(source)>>);
    verdict v;
    for (std::size_t i = 0; i < source.size(); ++i)
      v.require(same_bytes(there[i].position, source[i].position), "point", i);
    return copies.size();
  };
  const in_device_memory span{point_span(g.points)};
  const auto arrays = points_of(zip, x.size());
  const std::vector labels(g.points.size(), clearance::point_label::rest);
  CHECK((pieces(span) == 1 && pieces(arrays) == 3));
  CHECK((pieces(clearance::masked(span, labels.data())) == 1 && pieces(clearance::masked(arrays, labels.data())) == 3));
  CHECK(pieces(clearance::sharded(std::vector{span, span})) == 2);
  CHECK(pieces(clearance::sharded(std::vector{arrays, arrays})) == 6);
  CHECK((pieces(clearance::uncertain(span)) == 1 && pieces(clearance::uncertain(arrays)) == 3));
}

TEST_CASE("An iterator whose neighbours are no neighbours in memory is refused") {
  std::vector<tight> points(8);
  using forwards = adapted<tight*>;
  using backwards = adapted<tight*, -1>;
  CHECK(points_of(forwards{points.data()}, 8).points == reinterpret_cast<const vec3*>(points.data()));
  CHECK_THROWS_AS(points_of(backwards{points.data() + 7}, 8), std::invalid_argument);
  CHECK_THROWS_AS(points_of(std::reverse_iterator(points.data() + 8), 8), std::invalid_argument);
}

}  // namespace arrays_test
