// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A question about a robot and clouds of kinds that a program learns while it runs. Whoever asks sees an interface;
// each question is compiled where `prepare` is called, once for all kinds of clouds on a host.

#include <clearance/deadline.hpp>
#include <clearance/points/any_points.hpp>
#include <clearance/points/sensor_noise.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/query/query.hpp>
#include <clearance/usual_models.hpp>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace clearance::any {

/// A robot's trees: the fastest ones for spheres, or for triangles.
template <class B = host>
using model = std::variant<sphere_model<B>, triangle_model<B>>;

/// Clouds of these kinds, each with its pose, and what is uncertain about one.
template <class... Sources>
using cloud = std::variant<placed<Sources>...>;
template <class S>
using placed_uncertain = placed<uncertain<S, any_noise>>;

namespace detail {

template <class Cloud>
struct uncertain_kinds;
template <class... S>
struct uncertain_kinds<std::variant<placed<S>...>> {
  using alone = std::variant<placed_uncertain<S>...>;
  using too = std::variant<placed<S>..., placed_uncertain<S>...>;
};

template <class Cloud>
inline constexpr bool some_vague = false;
template <class... S>
inline constexpr bool some_vague<std::variant<placed<S>...>> = (vague_source<S> || ...);

template <class S>
any_points as_one(const S& source) {
  return source;
}
template <class S, class N>
auto as_one(const uncertain<S, N>& given) {
  return given.around_same(any_points(given.source), given.noise);
}
/// Clouds as a host reads them: all kinds as one, or as two.
template <class Cloud>
using clouds_as_one =
    std::vector<std::conditional_t<some_vague<Cloud>, std::variant<placed<any_points>, placed_uncertain<any_points>>,
                                   placed<any_points>>>;
/// The same clouds. A program that asks many questions says `extern template`, so that it is compiled once.
template <class Cloud>
clouds_as_one<Cloud> read_as_one(const std::vector<Cloud>& clouds) {
  clouds_as_one<Cloud> all;
  for_each_cloud(
      clouds, [&](const auto& source, const Eigen::Isometry3d& pose) { all.push_back(placed{as_one(source), pose}); });
  return all;
}

}  // namespace detail

/// `Cloud` with what is uncertain about it; and such clouds too.
template <class Cloud>
using uncertain_alone = typename detail::uncertain_kinds<Cloud>::alone;
template <class Cloud>
using uncertain_too = typename detail::uncertain_kinds<Cloud>::too;

/// A prepared question. One thread at a time asks it. `Cloud`: see `any::cloud`.
template <question Q, class Cloud>
class query {
 public:
  using question_type = Q;
  using cloud_type = Cloud;

  virtual ~query() = default;
  /// As clearance::query. Poses of a question about many configurations go to a device only if they are new.
  virtual typename Q::result operator()(std::span<const Eigen::Isometry3d> poses, const std::vector<Cloud>& clouds,
                                        const Q& q) = 0;
  /// The last frame, which only made the next one faster.
  virtual void forget() = 0;
};

/// One that can be asked up to a deadline.
template <question Q, class Cloud>
class timed_query : public query<Q, Cloud> {
 public:
  /// As ask_by.
  virtual so_far<typename Q::result> by(std::chrono::duration<double> deadline,
                                        std::span<const Eigen::Isometry3d> poses, const std::vector<Cloud>& clouds,
                                        const Q& q) = 0;
};

/// A clearance::query, and the trees that it is about, behind an interface: a `query`, or what derives from one and
/// adds to it.
template <class Interface, class On, class Robot>
class prepared : public Interface {
 public:
  using question_type = typename Interface::question_type;
  using cloud_type = typename Interface::cloud_type;

  /// `keeps` owns the robot.
  prepared(const On& on, std::shared_ptr<const void> keeps, const Robot& robot, const question_type& q)
      : keeps_(std::move(keeps)), query_(on, robot, q) {}

  typename question_type::result operator()(std::span<const Eigen::Isometry3d> poses,
                                            const std::vector<cloud_type>& clouds, const question_type& q) override {
    if constexpr (placing_engine<query_type>) {
      place(poses);
      return std::move(query_)(clouds, q);
    } else {
      return std::move(query_)(poses, read(clouds), q);
    }
  }
  void forget() override { query_.forget(); }

 protected:
  using query_type = decltype(clearance::query(std::declval<const On&>(), std::declval<const Robot&>(),
                                               std::declval<const question_type&>()));

  /// Takes the poses of many configurations to the device.
  void place(std::span<const Eigen::Isometry3d> poses) {
    if (std::ranges::equal(poses, placed_, [](const auto& a, const auto& b) { return a.matrix() == b.matrix(); }))
      return;
    placed_.clear();  // it may throw
    query_.place(poses);
    placed_.assign(poses.begin(), poses.end());
  }
  static decltype(auto) read(const std::vector<cloud_type>& clouds) {
    if constexpr (std::is_same_v<On, host> && !lists<question_type, of_images>)
      return detail::read_as_one(clouds);
    else
      return (clouds);
  }

  std::shared_ptr<const void> keeps_;
  query_type query_;

 private:
  std::vector<Eigen::Isometry3d> placed_;
};

/// The same with a deadline.
template <class Interface, class On, class Robot>
class timed : public prepared<Interface, On, Robot> {
 public:
  using prepared<Interface, On, Robot>::prepared;

  so_far<typename Interface::question_type::result> by(std::chrono::duration<double> deadline,
                                                       std::span<const Eigen::Isometry3d> poses,
                                                       const std::vector<typename Interface::cloud_type>& clouds,
                                                       const typename Interface::question_type& q) override {
    return ask_by(this->query_, poses, this->read(clouds), deadline, q);
  }
};

/// Can Q be asked about robots of these parts?
template <class Q, class Robot>
consteval bool is_about() {
  using part_view = typename decltype(std::declval<const Robot&>().view())::part_type;
  if constexpr (choosing::is_there<Q>())
    return Q::template about<part_view>;
  else
    return true;
}

/// Prepares a question about one of several kinds of trees, which the query keeps. `Prepared` is `prepared`, `timed`,
/// or a class of your own that derives from one. Throws std::invalid_argument as clearance::query, and if the question
/// is not about such a robot.
template <class Interface, template <class, class, class> class Prepared = prepared, class On, class... Robots>
std::unique_ptr<Interface> prepare(const On& on, const std::shared_ptr<const std::variant<Robots...>>& trees,
                                   const typename Interface::question_type& q) {
  return std::visit(
      [&]<class Robot>(const Robot& robot) -> std::unique_ptr<Interface> {
        if constexpr (is_about<typename Interface::question_type, Robot>())
          return std::make_unique<Prepared<Interface, On, Robot>>(on, trees, robot, q);
        else
          throw std::invalid_argument("clearance: this question is about robots of triangles");
      },
      *trees);
}

}  // namespace clearance::any
