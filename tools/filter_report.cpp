// SPDX-License-Identifier: BSD-3-Clause
#include "filter_report.hpp"

#include "report_text.hpp"

using namespace clearance;

namespace {

bool is_uncertain(const self_filter_result& filter, const min_distance_result& nearest) {
  return nearest.point != none &&
         filter.labels[filter.offsets[nearest.cloud] + nearest.point] == point_label::uncertain;
}

}  // namespace

own_points hide_own_points(const query_options& asked, backend_robot& there, poses_of poses, asked_clouds& clouds,
                           const std::vector<double>& radii) {
  own_points found{.filter = there.own_points(poses, *asked.self_filter), .unseen = {}};
  if (asked.unseen) {
    found.unseen = there.unseen(poses, {.room = *asked.unseen, .labels = found.filter.labels, .radii = radii}, false);
    found.unseen_query = there.query;
  }
  clouds.hide(found.filter.labels);
  found.upload = there.see(clouds.seen);
  return found;
}

void note_hidden(const query_options& asked, std::vector<std::string>& notes) {
  if (!asked.self_filter) return;
  const auto note = [&](const char* option, double metres) {
    if (metres <= *asked.self_filter)
      notes.push_back(
          text("%s %g: points that are certainly so near, an obstacle's too, are hidden by --self-filter %g; "
               "only uncertain ones lead to exit code 2",
               option, metres, *asked.self_filter));
  };
  if (asked.margin) note("--check", *asked.margin);
  if (!asked.zones.empty()) note("--zones", asked.zones[0]);
}

json filter_of(const query_options& asked, const self_filter_result& filter, const min_distance_result& nearest) {
  const bool any = nearest.point != none;
  return {{"padding", *asked.self_filter},
          {"own", filter.counts.own},
          {"uncertain", filter.counts.uncertain},
          {"nearest_is", any ? json(is_uncertain(filter, nearest) ? "uncertain" : "rest") : json(nullptr)}};
}

std::string filter_text(const query_options& asked, const self_filter_result& filter,
                        const min_distance_result& nearest) {
  const auto own = (unsigned long long)filter.counts.own;
  const std::string hidden =
      text("filter    %llu points are the robot's own (within %g m), and hidden; ", own, *asked.self_filter);
  if (own != 0 && nearest.state == state::no_data) return hidden + "no valid point is left\n";
  return hidden + text("%llu may be, and are not hidden%s\n", (unsigned long long)filter.counts.uncertain,
                       is_uncertain(filter, nearest) ? ", the nearest among them" : "");
}
