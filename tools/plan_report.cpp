// SPDX-License-Identifier: BSD-3-Clause
#include "plan_report.hpp"

#include "report_csv.hpp"

#include <algorithm>
#include <cmath>

using namespace clearance;

namespace {

/// The witness's cloud; null if there is none.
const observation* cloud_of(const plan_report& report, const min_distance_result& r) {
  return r.point == none ? nullptr : &(*report.clouds)[r.cloud];
}

/// What is certain of row k.
json certain_of(const plan_report& report, std::size_t k) {
  const certain_row& row = report.certain[k];
  const bool any = row.state != state::no_data, point = row.point != none;
  return {{"state", to_string(row.state)},
          {"lower", any ? or_null(row.lower) : json(nullptr)},
          {"part", row.part != none ? json((*report.bodies)[row.part].name) : json(nullptr)},
          {"cloud", point ? json((*report.clouds)[row.cloud].name) : json(nullptr)},
          {"point", point ? json(row.point) : json(nullptr)}};
}

/// What is said of a way; `time`, `from` and `to` are between 0 and 1.
json way_of(const plan_report& report, const motion_clearance_result& way) {
  const bool any = way.state != state::no_data;
  const auto given = [&](json value) { return any ? value : json(nullptr); };
  return {{"state", to_string(way.state)},
          {"lower", given(or_null(way.lower))},
          {"upper", given(or_null(way.upper))},
          {"time", given(or_null(way.time))},
          {"from", given(way.from)},
          {"to", given(way.to)},
          {"part", any && way.part != none ? json((*report.bodies)[way.part].name) : json(nullptr)},
          {"queries", way.queries},
          {"settled", way.settled}};
}

/// The way from row k to the next.
json way_of(const plan_report& report, std::size_t k) {
  json way = way_of(report, report.ways[k]);
  if (k < report.hidden.size()) way["unseen"] = way_of(report, report.hidden[k]);
  return way;
}

std::optional<std::size_t> first_within(const std::vector<motion_clearance_result>& ways, double margin) {
  for (std::size_t k = 0; k < ways.size(); ++k)
    if (!(ways[k].lower > margin)) return k;
  return std::nullopt;
}

/// The report on all ways.
json worst_of(const plan_report& report, const std::vector<motion_clearance_result>& ways) {
  const auto worst = std::ranges::min_element(ways, {}, &motion_clearance_result::lower);
  const bool some = !report.blind() && worst != ways.end();
  json out = {{"least_lower", some ? or_null(worst->lower) : json(nullptr)},
              {"at", some ? json(worst - ways.begin()) : json(nullptr)}};
  if (report.asked->margin) {
    const auto first = first_within(ways, *report.asked->margin);
    out["first_below"] = first ? json(*first) : json(nullptr);
  }
  return out;
}

}  // namespace

std::optional<std::size_t> plan_report::first_below() const {
  const auto near = [&](const certain_row& row) { return !(row.lower > *asked->margin); };
  const std::size_t first = blind()           ? 0
                            : certain.empty() ? found.first_below(*asked->margin)
                                              : std::size_t(std::ranges::find_if(certain, near) - certain.begin());
  return first < found.of.size() ? std::optional(first) : std::nullopt;
}

std::optional<std::size_t> plan_report::first_way_below() const { return first_within(ways, *asked->margin); }
std::optional<std::size_t> plan_report::first_hidden_way_below() const { return first_within(hidden, *asked->margin); }

std::optional<std::size_t> plan_report::first_hidden_below() const {
  for (std::size_t k = 0; k < unseen.size(); ++k)
    if (!of_unseen(k).passes()) return k;
  return std::nullopt;
}

unseen_report plan_report::of_unseen(std::size_t row) const {
  unseen_report made{.asked = asked, .found = &unseen[row], .clouds = {}, .bodies = bodies};
  for (const observation& cloud : *clouds) made.clouds.push_back(&cloud);
  return made;
}

json outcome_of(const plan_report& report) {
  const auto& rows = report.found.of;
  const auto least = std::ranges::min_element(rows, {}, [](const min_distance_result& r) { return r.distance; });
  const bool any = !report.blind() && std::isfinite(least->distance);
  json out = {{"rows", rows.size()},
              {"least", any ? json(least->distance) : json(nullptr)},
              {"at", any ? json(least - rows.begin()) : json(nullptr)}};

  if (report.asked->margin) {
    const auto first = report.first_below();
    out["first_below"] = first ? json(*first) : json(nullptr);
  }
  if (!report.certain.empty()) {
    const auto worst = std::ranges::min_element(report.certain, {}, &certain_row::lower);
    out["certain"] = {{"least_lower", report.blind() ? json(nullptr) : or_null(worst->lower)},
                      {"at", report.blind() ? json(nullptr) : json(worst - report.certain.begin())}};
  }
  if (!report.unseen.empty()) {
    const auto worst = std::ranges::min_element(report.unseen, {}, [](const unseen_result& r) { return r.all.lower; });
    out["unseen"] = {{"least_lower", or_null(worst->all.lower)}, {"at", worst - report.unseen.begin()}};
    if (report.asked->margin) {
      const auto first = report.first_hidden_below();
      out["unseen"]["first_below"] = first ? json(*first) : json(nullptr);
    }
  }

  if (!report.asked->between) return out;
  out["ways"] = worst_of(report, report.ways);
  if (report.asked->unseen) out["ways"]["unseen"] = worst_of(report, report.hidden);
  return out;
}

std::string to_json(const plan_report& report) {
  std::string out;
  for (std::size_t k = 0; k < report.found.of.size(); ++k) {
    const min_distance_result& r = report.found.of[k];
    json row = {{"row", k}};
    row.update(witness(r, cloud_of(report, r), r.point, *report.bodies));
    if (!report.certain.empty()) row["certain"] = certain_of(report, k);
    if (!report.unseen.empty()) row["unseen"] = unseen_of(report.of_unseen(k));
    if (k < report.ways.size()) row["way"] = way_of(report, k);
    out += json_text(row, -1);
  }

  json last = {{"plan", outcome_of(report)}};
  if (report.asked->margin) last["check"] = {{"margin", *report.asked->margin}, {"passes", report.code() == 0}};
  min_distance_result counted = report.found.of[0];
  for (const observation& cloud : *report.clouds) cloud.recount(counted);
  last["points"] = counts(counted);
  last["clouds"] = json::array();
  for (const observation& cloud : *report.clouds) last["clouds"].push_back(about_cloud(cloud));
  last["model"] = to_string(report.asked->model);
  if (report.fields > 0) last["fields"] = {{"links", report.fields}, {"cached", report.fields_cached}};
  last["backend"] = report.asked->on_device ? "device" : "host";
  last["seconds"] = {{"load", report.load},
                     {"pack", report.pack},
                     {"build", report.build},
                     {"upload", report.upload},
                     {"query", report.query}};
  return out + json_text(last, -1);
}

std::string to_csv(const plan_report& report) {
  std::string out =
      std::string("row,") + witness_columns +
      (report.certain.empty() ? "" : ",certain_state,certain_lower,certain_part") +
      (report.unseen.empty() ? "" : std::string(",") + unseen_columns) +
      (report.asked->between ? ",way_state,way_lower,way_upper,way_time,way_from,way_to,way_part" : "") +
      (report.asked->between && report.asked->unseen ? ",way_unseen_state,way_unseen_lower,way_unseen_part\n" : "\n");

  for (std::size_t k = 0; k < report.found.of.size(); ++k) {
    const min_distance_result& r = report.found.of[k];
    out += std::to_string(k) + ',' + witness_cells(r, cloud_of(report, r), r.point, *report.bodies);
    if (!report.certain.empty())
      for (const json row = certain_of(report, k); const char* const name : {"state", "lower", "part"})
        out += ',' + csv_word(row[name]);
    if (!report.unseen.empty()) out += ',' + unseen_cells(report.of_unseen(k));
    if (report.asked->between) {
      const json way = k < report.ways.size() ? way_of(report, k) : json::object();  // the last has none
      for (const char* name : {"state", "lower", "upper", "time", "from", "to", "part"})
        out += ',' + (way.contains(name) ? csv_word(way[name]) : std::string());
      for (const char* name : {"state", "lower", "part"})
        if (report.asked->unseen)
          out +=
              ',' + (way.contains("unseen") ? csv_word(way["unseen"][name], *name == 'l' ? report.hidden[k].lower : 0)
                                            : std::string());
    }
    out += '\n';
  }
  return out;
}
