// SPDX-License-Identifier: BSD-3-Clause
// What holds a view: it cannot be made of what is gone after the statement, and copies of it outlive the original. Run
// it under the address sanitizer, too, which sees freed memory.
#include "forms/forms.hpp"

#include <clearance/frames/cropped_clouds.hpp>
#include <clearance/frames/mapped_clouds.hpp>
#include <clearance/io/joint_motion.hpp>
#include <clearance/io/part_radii.hpp>
#include <clearance/points/camera.hpp>
#include <clearance/points/point_cloud2.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/robot/replicas.hpp>
#include <clearance/seen_and_unseen.hpp>

namespace lifetimes_test {

using namespace testing;
using clearance::host, clearance::query, clearance::chunked_query;

namespace {

using a_part = decltype(clearance::make_part<clearance::sphere>(std::vector<inner_sphere>()));
using a_model = clearance::model<a_part>;
using a_view = decltype(std::declval<const a_model&>().view());
using an_attached = decltype(clearance::attach(host{}, std::declval<const a_model&>(), std::declval<const a_model&>()));
using points = std::vector<vec3>;
using words = std::vector<clearance::point_label>;
using clearance::point_span, clearance::point_label;

/// Robots of questions that are asked later.
template <class R>
concept prepared = requires(R&& r) { query(host{}, static_cast<R&&>(r), clearance::min_distance{}); };
template <class R>
concept prepared_in_chunks = requires(R&& r) { chunked_query(host{}, static_cast<R&&>(r), clearance::min_distance{}); };
template <class R>
concept asked_at_once = requires(R&& r, const std::vector<Eigen::Isometry3d>& poses, const points& p) {
  clearance::ask(host{}, static_cast<R&&>(r), poses, p, clearance::min_distance{});
};
template <class R>
constexpr bool refused = !prepared<R> && !prepared<const R> && !prepared_in_chunks<R> && !prepared_in_chunks<const R>;
template <class R>
constexpr bool taken = prepared<R> && prepared_in_chunks<R>;
static_assert(refused<a_part> && refused<a_model> && refused<an_attached>);
static_assert(taken<a_part&> && taken<a_model&> && taken<an_attached&> && taken<const a_model&>);
static_assert(taken<a_view> && taken<a_view&>);
static_assert(asked_at_once<a_model> && asked_at_once<a_model&> && asked_at_once<an_attached>);

template <class R, class O>
concept attaches = requires(R&& r, O&& o) { clearance::attach(host{}, static_cast<R&&>(r), static_cast<O&&>(o)); };
static_assert(attaches<a_model&, a_model&> && attaches<a_view, a_view> && attaches<an_attached, a_model&>);
static_assert(!attaches<a_model, a_model&> && !attaches<a_model&, a_model> && !attaches<a_model, a_model>);
static_assert(!attaches<a_view, a_model> && !attaches<a_model, a_view> && !attaches<const a_model, a_view&>);

/// Views of owners.
template <class R>
concept viewed = requires(R&& r) { static_cast<R&&>(r).view(); };
template <class R>
constexpr bool viewed_by_name = viewed<R&> && viewed<const R&> && !viewed<R> && !viewed<const R>;
static_assert(viewed_by_name<a_model> && viewed_by_name<an_attached> && viewed_by_name<clearance::replicas<a_model>>);
static_assert(viewed_by_name<clearance::joint_chain<host>>);

/// Points, radii, labels, minima, errors and messages.
template <class T, class From>
constexpr bool of = std::is_constructible_v<T, From>;
template <class T, class Range>
constexpr bool by_name = of<T, Range&> && of<T, const Range&> && !of<T, Range> && !of<T, const Range>;
static_assert(by_name<point_span, points> && by_name<point_span, std::array<vec3, 2>>);
static_assert(of<point_span, std::span<const vec3>> && of<point_span, std::span<vec3>> && of<point_span, point_span>);
static_assert(by_name<clearance::point_radii, std::vector<real>>);
static_assert(by_name<clearance::borrowed<double>, std::vector<double>>);
static_assert(by_name<clearance::borrowed<double>, std::array<double, 3>>);
static_assert(of<clearance::borrowed<double>, std::span<double>> && of<clearance::borrowed<double>, double (&)[3]>);
static_assert(by_name<clearance::borrowed_text, std::string> && of<clearance::borrowed_text, const char*>);
static_assert(of<clearance::borrowed_text, std::string_view>);
template <class L>
concept labelled = requires(L&& l) { clearance::unseen{.labels = static_cast<L&&>(l)}; };
template <class L>
concept labelled_too = requires(L&& l, clearance::seen_and_unseen q) { q.labels = static_cast<L&&>(l); };
template <class M>
concept witnessed = requires(M&& m) { clearance::part_witnesses{static_cast<M&&>(m)}; };
template <class E>
concept doubted = requires(E&& e) { clearance::io::joint_uncertainty{.errors = static_cast<E&&>(e)}; };
template <class E>
concept hurried = requires(E&& e) { clearance::io::joint_uncertainty{.speeds = static_cast<E&&>(e)}; };
template <class D>
concept bends = requires(D&& d) { clearance::camera_info{.d = static_cast<D&&>(d)}; };
template <class N>
concept names_a_lens = requires(N&& n) { clearance::camera_info{.distortion_model = static_cast<N&&>(n)}; };
template <class N>
concept names_a_field = requires(N&& n) { clearance::point_field{.name = static_cast<N&&>(n)}; };
template <class D>
concept holds_points = requires(D&& d) { clearance::point_cloud2{.data = static_cast<D&&>(d)}; };
template <class D>
concept holds_fields = requires(D&& d) { clearance::point_cloud2{.fields = static_cast<D&&>(d)}; };
using minima = std::vector<clearance::part_minimum>;
using numbers = std::vector<double>;
static_assert(labelled<words&> && labelled<std::span<point_label>> && !labelled<words> && !labelled<const words>);
static_assert(labelled_too<words&> && !labelled_too<words>);
static_assert(witnessed<minima&> && witnessed<std::span<clearance::part_minimum>> && !witnessed<minima>);
static_assert(doubted<numbers&> && !doubted<numbers> && hurried<const numbers&> && !hurried<numbers>);
static_assert(bends<numbers&> && bends<std::array<double, 4>&> && !bends<numbers> && !bends<std::array<double, 4>>);
static_assert(names_a_lens<std::string&> && names_a_lens<const char*> && !names_a_lens<std::string>);
static_assert(names_a_field<std::string&> && names_a_field<std::string_view> && !names_a_field<std::string>);
static_assert(holds_points<std::vector<std::byte>&> && !holds_points<std::vector<std::byte>>);
static_assert(holds_fields<std::vector<clearance::point_field>&> && !holds_fields<std::vector<clearance::point_field>>);

/// Images of a table of rays, masks, and motions by joints.
template <class Table, class Pixels>
concept pictured = requires(Table&& t, Pixels&& p) { static_cast<Table&&>(t).image(static_cast<Pixels&&>(p), 1u, 1u); };
using table = clearance::ray_table;
using pixels = std::vector<float>;
static_assert(pictured<table&, pixels&> && pictured<const table&, std::span<const float>>);
static_assert(!pictured<table, pixels&> && !pictured<table&, pixels> && !pictured<const table, pixels&>);
template <class C>
concept hides = requires(C&& c, const point_label* l) { clearance::masked_clouds(static_cast<C&&>(c), l); };
static_assert(hides<points&> && hides<point_span> && hides<std::vector<point_span>>);
static_assert(hides<std::vector<clearance::placed<point_span>>> && hides<std::tuple<points>&>);
static_assert(!hides<points> && !hides<std::tuple<points>> && !hides<std::vector<points>>);
template <class C>
concept crops = requires(C&& c, const clearance::crop& w) { clearance::cropped_clouds(static_cast<C&&>(c), w); };
static_assert(crops<points&> && crops<point_span> && crops<std::vector<point_span>> && crops<std::tuple<points>&>);
static_assert(!crops<points> && !crops<std::tuple<points>> && !crops<std::vector<points>>);
using tree = clearance::io::kinematic_tree;
struct robot_with_parts {
  struct part {
    std::size_t link;
  };
  tree its;
  std::vector<part> all;
  const tree& kinematics() const { return its; }
  const std::vector<part>& parts() const { return all; }
};
using links = std::vector<std::size_t>;
using clearance::io::joint_motion;
static_assert(std::is_constructible_v<joint_motion, tree&, links, numbers, numbers>);
static_assert(!std::is_constructible_v<joint_motion, tree, links, numbers, numbers>);
static_assert(std::is_constructible_v<joint_motion, robot_with_parts&, numbers, numbers>);
static_assert(!std::is_constructible_v<joint_motion, robot_with_parts, numbers, numbers>);

/// Parts of results: of a temporary one they are copies.
template <class R, class T>
constexpr bool gives_copy_of_part = std::is_same_v<decltype(std::declval<R>().of(0)), std::vector<T>> &&
                                    std::is_same_v<decltype(std::declval<R&>().of(0)), std::span<const T>>;
template <class R, class T>
constexpr bool gives_copy_of_way = std::is_same_v<decltype(std::declval<R>().trajectory(0, 1)), std::vector<T>> &&
                                   std::is_same_v<decltype(std::declval<R&>().trajectory(0, 1)), std::span<const T>>;
using clearance::min_distance_result;
static_assert(gives_copy_of_part<clearance::part_distances, real>);
static_assert(gives_copy_of_part<clearance::nearest_k_result, clearance::pair_distance>);
static_assert(gives_copy_of_part<clearance::min_distances_per_part_result, min_distance_result>);
static_assert(gives_copy_of_way<clearance::min_distances_result, min_distance_result>);
static_assert(gives_copy_of_way<clearance::in_collisions_result, clearance::state>);
static_assert(std::is_same_v<decltype(std::declval<clearance::zones_result>().of(0, 0)), clearance::zone>);

template <class Made>
std::unique_ptr<Made> elsewhere(Made&& made) {
  return std::make_unique<Made>(std::move(made));
}

/// A copy and a moved object answer as the original, when that is gone; and so does one that was assigned.
template <class Prepared, class Ask>
void outlives(verdict& v, const char* name, std::unique_ptr<Prepared> original, const Ask& ask) {
  const auto expected = bits_of(ask(*original));
  auto copy = std::make_unique<Prepared>(*original);
  auto moved = std::make_unique<Prepared>(std::move(*original));
  original.reset();
  v.require(bits_of(ask(*copy)) == expected, name, ": a copy");
  v.require(bits_of(ask(*moved)) == expected, name, ": moved");
  if constexpr (std::is_copy_assignable_v<Prepared>) {
    auto other = std::make_unique<Prepared>(*copy);
    *other = *moved;
    moved.reset(), copy.reset();
    v.require(bits_of(ask(*other)) == expected, name, ": assigned");
  } else {
    moved.reset();
    v.require(bits_of(ask(*copy)) == expected, name, ": a copy, again");
  }
}

}  // namespace

TEST_CASE("a copy of a prepared question about a part outlives the original") {
  verdict v;
  dice d(31);
  const auto part = clearance::make_part<clearance::sphere>(random_spheres(d, 20));
  const auto mesh = clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::cube(0.2)));
  const Eigen::Isometry3d pose = d.pose(1);
  const auto cloud = d.points(6000, 2);
  std::size_t asked = 0;
  const auto about = [&](const auto& robot) {
    return [&](const char* name, const auto& q) {
      outlives(v, name, elsewhere(query(host{}, robot, q)), [&](auto& its) { return its(pose, point_span(cloud)); });
      ++asked;
    };
  };
  for_each_question(about(part)), for_each_question_of_meshes(about(mesh));
  const auto minimum = clearance::ask(host{}, part, pose, cloud, clearance::min_distance_per_part{});
  about(part)("part_witnesses", clearance::part_witnesses{minimum.parts});
  CHECK(asked == 16);
  const std::vector<float> depths(64 * 48, 2.0f);
  const clearance::depth_image<float> image(depths.data(), 64, 48, {50, 50, 32, 24});
  const words labels(depths.size());
  clearance::unseen unseen{.labels = labels, .edges = true};
  clearance::seen_and_unseen both;
  both.labels = labels;
  const auto look = [&](auto& its) { return its(pose, image).all; };
  outlives(v, "unseen", elsewhere(query(host{}, part, unseen)), look);
  outlives(v, "seen_and_unseen", elsewhere(query(host{}, part, both)),
           [&](auto& its) { return its(pose, image).seen; });
}

TEST_CASE("a copy of a question in chunks about a part outlives the original") {
  verdict v;
  dice d(32);
  const auto part = clearance::make_part<clearance::sphere>(random_spheres(d, 20));
  const Eigen::Isometry3d pose = d.pose(1);
  const auto cloud = d.points(9000, 2);
  for_each_question([&]<class Q>(const char* name, const Q& q) {
    if constexpr (forms_of<Q>::in_pieces)
      outlives(v, name, elsewhere(chunked_query(host{}, part, q)), [&](auto& its) {
        clearance::chunked in_chunks(point_span(cloud), 4096);
        return its(pose, in_chunks);
      });
  });
}

TEST_CASE("copies of owners have views of their own") {
  dice d(33);
  const std::vector poses(2, d.pose(1));
  const auto cloud = d.points(500, 2);
  const auto part = clearance::make_part<clearance::sphere>(random_spheres(d, 20));
  const auto ask = [&](const auto& robot) {
    return clearance::ask(host{}, robot, poses, cloud, clearance::min_distance{});
  };
  auto original = std::make_unique<a_model>(std::vector{part, part});
  const auto expected = ask(*original);
  const auto copy = std::make_unique<a_model>(*original);
  auto several = std::make_unique<clearance::replicas<a_model>>(std::vector{*original, *original});
  const auto alike = std::make_unique<clearance::replicas<a_model>>(*several);
  const clearance::model alone{std::vector{part}};
  auto held = std::make_unique<an_attached>(clearance::attach(host{}, alone, alone));
  const auto held_too = std::make_unique<an_attached>(*held);
  original.reset(), several.reset(), held.reset();
  CHECK(same_answer(ask(*copy), expected));
  for (const auto& view : alike->view().each) CHECK(same_answer(ask(view), expected));
  CHECK(same_answer(ask(*held_too), expected));
}

TEST_CASE("what one statement makes and consumes needs no name") {
  dice d(34);
  const auto balls = random_spheres(d, 20);
  const std::vector poses(1, d.pose(1));
  const auto cloud = d.points(500, 2);
  const auto part = clearance::make_part<clearance::sphere>(balls);
  const auto expected = clearance::ask(host{}, part, poses, cloud, clearance::min_distances{});
  CHECK(same_answer(clearance::ask(host{}, clearance::make_model<clearance::sphere>(std::vector(1, balls)), poses,
                                   std::vector(cloud), clearance::min_distances{}),
                    expected));
  // The query is gone, and it kept the result.
  const auto& kept = query(host{}, part, clearance::min_distances{})(poses, std::vector(cloud));
  CHECK(same_answer(kept, expected));
}

}  // namespace lifetimes_test
