// SPDX-License-Identifier: BSD-3-Clause
#include "unseen_report.hpp"

#include "report_csv.hpp"
#include "report_text.hpp"

#include <cmath>

using namespace clearance;

namespace {

json pixel_of(const observation* cloud, std::uint32_t point) {
  const auto at = cloud ? pixel(*cloud, point) : std::nullopt;
  return at ? json{at->first, at->second} : json(nullptr);
}

std::string pixel_text(const unseen_report& report, std::uint32_t cloud, std::uint32_t point) {
  const observation& image = *report.clouds[cloud];
  const auto at = pixel(image, point).value();
  return text("pixel %llu,%llu of ", (unsigned long long)at.first, (unsigned long long)at.second) +
         io::printable(image.name);
}

json shadow_of(const unseen_report& report) {
  const min_distance_result& r = report.found->own_shadow;
  const bool any = r.part != none;
  return {{"state", to_string(r.state)},
          {"distance", any ? or_null(r.distance) : json(nullptr)},
          {"lower", any ? or_null(r.lower) : json(nullptr)},
          {"part", any ? json((*report.bodies)[r.part].name) : json(nullptr)},
          {"cloud", any ? json(report.clouds[r.cloud]->name) : json(nullptr)},
          {"pixel", any ? pixel_of(report.clouds[r.cloud], r.point) : json(nullptr)},
          {"pixels", r.valid}};
}

}  // namespace

json unseen_of(const unseen_report& report) {
  const min_distance_result& r = report.found->all;
  json out = {{"near", report.asked->unseen->nearest}, {"far", report.asked->unseen->farthest}};
  out.update(witness(r, report.cloud(r.cloud), r.point, *report.bodies));
  out["pixels"] = {{"seen", r.seen}, {"hiding", r.valid}};
  if (report.filtered) out["own_shadow"] = shadow_of(report);
  if (report.asked->margin) out["passes"] = report.passes();
  return out;
}

json unseen_of(const unseen_report& report, std::size_t part) {
  if (report.found->parts.empty()) return nullptr;
  const unseen_part& found = report.found->parts[part];
  const observation* cloud = report.cloud(found.cloud);
  return {{"distance", or_null(found.distance)},
          {"lower", or_null(found.lower)},
          {"cloud", cloud ? json(cloud->name) : json(nullptr)},
          {"pixel", pixel_of(cloud, found.point)},
          {"out_of_view", or_null(found.out_of_view)}};
}

std::string unseen_text(const unseen_report& report) {
  const min_distance_result& r = report.found->all;
  std::string out = "unseen    ";
  if (r.state == state::no_data) {
    out += "nothing is known";
  } else if (r.part == none) {
    out += text("no pixel hides anything nearer than %g m", double(report.asked->unseen->farthest));
  } else {
    out += text("%.6f m, certainly at least %.6f m", double(r.distance), double(r.lower));
    if (r.state == state::unknown) out += ": it reaches into room that no camera sees";
    out +=
        "; behind " + pixel_text(report, r.cloud, r.point) + ", part " + io::printable((*report.bodies)[r.part].name);
  }
  if (report.asked->margin) out += text("; %s %g m", report.passes() ? "above" : "not above", *report.asked->margin);
  out += '\n';
  if (!report.filtered) return out;
  const min_distance_result& own = report.found->own_shadow;
  out += text("shadow    %llu pixels of the robot's own points hide room, too", (unsigned long long)own.valid);
  if (own.part != none)
    out += text(": %.6f m away, behind ", double(own.distance)) + pixel_text(report, own.cloud, own.point) + ", part " +
           io::printable((*report.bodies)[own.part].name);
  return out + '\n';
}

std::string unseen_parts_text(const unseen_report& report) {
  std::string out = "\nunseen (how far from each link, at least how far, and how much of it no camera shows)\n";
  for (std::size_t k = 0; k < report.found->parts.size(); ++k) {
    const unseen_part& found = report.found->parts[k];
    out += name_column((*report.bodies)[k].name);
    out += found.part == none ? "         -" : text("%10.6f m, %10.6f m", double(found.distance), double(found.lower));
    out += std::isnan(found.out_of_view) ? "" : text(", %3.0f %%", 100 * double(found.out_of_view));
    out += found.part == none ? "\n" : ", " + pixel_text(report, found.cloud, found.point) + '\n';
  }
  return out;
}

std::string unseen_cells(const unseen_report& report) {
  const min_distance_result& r = report.found->all;
  const auto cell = [](double value) { return ',' + csv_word(or_null(value), value); };
  const bool any = r.part != none;
  const json at = any ? pixel_of(report.clouds[r.cloud], r.point) : json(nullptr);
  std::string out = to_string(r.state) + (r.state == state::no_data ? ",," : cell(r.distance) + cell(r.lower)) + ',' +
                    (any ? csv_word((*report.bodies)[r.part].name) : "");
  for (std::size_t i = 0; i < 2; ++i) out += ',' + (at.is_null() ? std::string() : at[i].dump());
  return out;
}
