// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Your own questions: every pair (point, part) that is near enough goes to an answer. Runs on the host; include
// collect.cuh for a device.

#include <clearance/answer/pairwise.hpp>
#include <clearance/answer/search_on.hpp>
#include <clearance/backend/staged.hpp>
#include <clearance/scan/plain_pass.hpp>

namespace clearance {

namespace pairwise {

/// For a backend without a scan of its own: a loop over points.
template <class On>
struct pairs_on {
  static_assert(
      !requires { typename On::own_scan; },
      "a device has a scan of its own: include <clearance/collect.cuh>, not the .hpp");
  static constexpr bool meets_points = false;  ///< A scan that does tells a `labelling_answer` of each.

  template <class PartView, class Clouds, answer Answer, class Here>
  static void once(const On& on, const model_view<PartView>& model, std::span<const Eigen::Isometry3d> poses,
                   const Clouds& clouds, const Answer& answer, point_counts* counts, const Here& here) {
    auto least = staged(on, std::vector<std::uint32_t>(coarse_answer<Answer> ? model.size() : 0, ordered(infinity)));
    const auto of_cloud = [&](const auto&, const frames::turn& now) {
      return each_pair<Answer>{answer, now.cloud, now.first, least.data()};
    };
    scan::plain_pass(on, model, poses, clouds, of_cloud, counts, here);
  }

  /// For one robot, frame after frame.
  template <class PartView>
  struct kept {
    On on;
    model_view<PartView> model;

    template <class Clouds, answer Answer, class Here>
    void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer,
                 point_counts* counts, const Here& here) {
      once(on, model, poses, clouds, answer, counts, here);
    }
  };
};

}  // namespace pairwise

/// Gives `answer` every pair of a point and a part that is within its reach. `poses` and `clouds` as for min_distance.
/// Blocks, and returns the counts of points. Throws std::invalid_argument if the number of poses is wrong or one is not
/// rigid.
template <class On, robot Robot, class Clouds, class Answer>
point_counts collect(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                     const Answer& answer) {
  static_assert(explain_answer<Answer>() && explain_clouds<Clouds>());
  auto counts = on.template make_scratch<point_counts>(1);
  minimum::cloud_copies<On> copies;
  pairwise::pairs_on<On>::once(on, view_of(robot), poses, clouds, answer, counts.data(),
                               minimum::readable_on<On>{on, copies});
  return on.copy_out(counts.data(), 1)[0];
}

/// Enqueues it; clouds, and the memory of `answer` and `counts`, must stay valid until it is done.
template <class On, robot Robot, class Clouds, class Answer>
void collect_async(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                   const Answer& answer, point_counts* counts) {
  static_assert(explain_answer<Answer>() && explain_clouds<Clouds>());
  pairwise::pairs_on<On>::once(on, view_of(robot), poses, clouds, answer, counts, minimum::as_it_is{});
}

}  // namespace clearance
