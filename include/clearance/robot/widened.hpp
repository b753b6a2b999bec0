// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Parts that may be elsewhere than their poses say.

#include <clearance/backends/kept_memory.hpp>
#include <clearance/points/sensor_noise.hpp>
#include <clearance/robot/model.hpp>

namespace clearance {

/// By how much part k may be elsewhere, in metres: of no radius (0), one for all parts, or one per part.
inline double radius_of(std::span<const double> radii, std::size_t k) {
  return radii.empty() ? 0 : radii[radii.size() == 1 ? 0 : k];
}

/// Throws std::invalid_argument if there is neither no radius, one, nor one per part, or if one is negative or not
/// finite.
inline void check_radii(std::span<const double> radii, std::size_t parts) {
  if (radii.size() > 1 && radii.size() != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but " +
                                std::to_string(radii.size()) + " radii of parts");
  for (const double r : radii) detail::check_uncertain(r, "a part's radius");
}

/// The facts of a part that may be so many metres elsewhere. This is the only rule: a radius is a tolerance, because
/// the true surface may be so far from the part's, either way.
inline part_facts widened(part_facts facts, double radius) {
  if (radius != 0) facts.tolerance = rounded_up(double(facts.tolerance) + radius);
  return facts;
}

/// Copies part views with other tolerances.
template <class PartView>
struct widen_parts {
  const PartView* from;
  const real* tolerances;
  PartView* to;

  CLEARANCE_HD void operator()(std::size_t k) const {
    PartView its = from[k];
    its.facts.tolerance = tolerances[k];
    to[k] = its;
  }
};

/// A robot whose parts are `widened`, anew for every frame, in memory that is kept.
template <class On, class PartView>
class widened_model {
 public:
  template <class... Memory>
  widened_model(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on), model_(model), memory_(on, from...) {}

  /// With these radii, until the next call; without radii the robot that was given. Enqueued. Throws as check_radii.
  model_view<PartView> operator()(std::span<const double> radii) {
    check_radii(radii, model_.size());
    if (radii.empty() || model_.size() == 0) return model_;
    facts_.clear();
    tolerances_.clear();
    for (std::size_t k = 0; k < model_.size(); ++k) {
      facts_.push_back(widened(model_.facts[k], radius_of(radii, k)));
      tolerances_.push_back(facts_.back().tolerance);
    }
    memory_.begin();
    const real* const tolerances = std::get<0>(memory_.put(tolerances_));
    PartView* const views = memory_.template space<PartView>(model_.size()).data();
    on_.for_each(model_.size(), widen_parts<PartView>{model_.parts, tolerances, views});
    return {views, facts_, model_.depth, model_.width, model_.fields, model_.cells};
  }

 private:
  On on_;
  model_view<PartView> model_;
  backends::kept_memory<On> memory_;
  std::vector<part_facts> facts_;
  std::vector<real> tolerances_;
};

}  // namespace clearance
