// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which scan gives an answer all pairs, by where it runs.

#include <clearance/concepts.hpp>
#include <clearance/pairwise/each_pair.hpp>
#include <clearance/scan/scan_body.hpp>

namespace clearance {

/// A copy for one call where `on` runs. It does not wait.
template <backend On, class T>
auto staged(const On& on, const std::vector<T>& data) {
  auto copy = on.template make_scratch<T>(data.size());
  on.stage(std::span<const T>(data), copy.data());
  return copy;
}

}  // namespace clearance

namespace clearance::pairwise {

/// For a backend without a scan of its own: a loop over points.
template <class On>
struct pairs_on {
  static constexpr bool meets_points = false;  ///< A scan that does tells a `labelling_answer` of each.

  /// For one robot, frame after frame.
  template <class PartView>
  struct kept {
    template <class... Memory>
    kept(const On& on, const model_view<PartView>& model, Memory...) : on(on), model(model) {}

    On on;
    model_view<PartView> model;

    template <class Clouds, answer Answer, class Here>
    void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer,
                 point_counts* counts, const Here& here) {
      auto least = staged(on, std::vector<std::uint32_t>(coarse_answer<Answer> ? model.size() : 0, ordered(infinity)));
      const auto of_cloud = [&](const auto&, const frames::turn& now) {
        return each_pair<Answer>{answer, now.cloud, now.first, least.data(), model.fields};
      };
      scan::plain_pass(on, model, poses, clouds, of_cloud, counts, here);
    }
  };
};

}  // namespace clearance::pairwise
