// SPDX-License-Identifier: BSD-3-Clause
#include "frame_report.hpp"

#include "report_csv.hpp"

using namespace clearance;

namespace {

/// After a comma: what there is to say about each part.
std::string part_columns(const frame_report& report) {
  std::string out;
  for (std::size_t k = 0; report.each_part() && k < report.bodies->size(); ++k) {
    const auto column = [&](const char* what) { out += ',' + csv_word((*report.bodies)[k].name + what); };
    column(" distance");
    if (report.certain) column(" certain_lower");
    if (report.unseen) {
      column(" unseen");
      column(" unseen_lower");
      column(" out_of_view");
    }
  }
  return out;
}

std::string part_cells(const frame_report& report) {
  std::string out;
  for (std::size_t k = 0; report.each_part() && k < report.bodies->size(); ++k) {
    const part_minimum& nearest = report.found.parts[k];
    const auto cell = [&](double value, bool known) {
      out += ',' + (known ? csv_word(or_null(value), value) : std::string());
    };
    cell(nearest.distance, nearest.point != none);
    if (report.certain) cell(report.certain->parts[k].lower, report.certain->parts[k].part != none);
    if (!report.unseen) continue;
    const unseen_result& unseen = *report.unseen->found;
    const unseen_part hidden = k < unseen.parts.size() ? unseen.parts[k] : unseen_part{};
    const bool any = k < unseen.parts.size(), known = any && unseen.all.state != state::no_data;
    cell(hidden.distance, known);
    cell(hidden.lower, known);
    cell(hidden.out_of_view, any);
  }
  return out;
}

}  // namespace

std::string to_json(const frame_report& report) {
  json out = {{"frame", report.frame}, {"file", report.file}};
  if (report.stamped) {
    out["stamp"] = report.stamped->stamp;
    out["joints_off"] = report.stamped->joints.off;
  }
  out.update(witness(report.found.result, report.cloud, report.point, *report.bodies));
  out["points"] = counts(report.found.result);
  out["upload_us"] = microseconds(report.upload);
  out["latency_us"] = microseconds(report.query);

  if (report.filter) out["filter"] = filter_of(*report.asked, *report.filter, report.found.result);
  if (report.certain) out["certain"] = certain_of(*report.certain, {report.cloud}, *report.bodies);
  if (report.unseen) {
    json& unseen = out["unseen"] = unseen_of(*report.unseen);
    unseen["latency_us"] = microseconds(report.unseen_query);
  }

  if (report.each_part()) out["parts"] = json::array();
  for (std::size_t k = 0; report.each_part() && k < report.bodies->size(); ++k) {
    json part = {{"name", (*report.bodies)[k].name}, {"distance", or_null(report.found.parts[k].distance)}};
    if (report.certain) part["certain"] = certain_of(report.certain->parts[k], {report.cloud});
    if (report.unseen) part["unseen"] = unseen_of(*report.unseen, k);
    out["parts"].push_back(part);
  }

  if (report.plan) {
    json& plan = out["plan"] = outcome_of(*report.plan);
    plan["lower"] = json::array();
    for (const min_distance_result& r : report.plan->found.of)
      plan["lower"].push_back(r.state == state::no_data ? json(nullptr) : or_null(r.lower));
    for (const certain_row& row : report.plan->certain)
      plan["certain_lower"].push_back(row.state == state::no_data ? json(nullptr) : or_null(row.lower));
    for (const unseen_result& row : report.plan->unseen) plan["unseen_lower"].push_back(or_null(row.all.lower));
    plan["latency_us"] = microseconds(report.plan->query);
  }
  return json_text(out, -1);
}

std::string to_csv(const frame_report& report) {
  std::string out;
  if (report.frame == 0) {
    out = std::string("frame,file,") + witness_columns + ",latency_us";
    if (report.stamped) out += ",stamp,joints_off";
    if (report.filter) out += ",own,own_uncertain";
    if (report.certain) out += ",certain_state,certain_lower,certain_upper";
    if (report.unseen) out += std::string(",") + unseen_columns;
    out += part_columns(report);
    if (report.plan) out += report.plan->asked->margin ? ",plan_least,plan_at,plan_first_below" : ",plan_least,plan_at";
    if (report.plan && !report.plan->certain.empty()) out += ",plan_certain_lower,plan_certain_at";
    if (report.plan && !report.plan->unseen.empty()) out += ",plan_unseen_lower,plan_unseen_at";
    out += '\n';
  }

  out += std::to_string(report.frame) + ',' + csv_word(report.file) + ',' +
         witness_cells(report.found.result, report.cloud, report.point, *report.bodies) + ',' +
         csv_word(microseconds(report.query));
  if (report.stamped) out += ',' + csv_word(report.stamped->stamp) + ',' + csv_word(report.stamped->joints.off);
  if (report.filter) out += ',' + csv_word(report.filter->counts.own) + ',' + csv_word(report.filter->counts.uncertain);
  if (report.certain)
    out += std::string(",") + to_string(report.certain->state) + ',' + csv_word(or_null(report.certain->lower)) + ',' +
           csv_word(or_null(report.certain->upper), report.certain->upper);
  if (report.unseen) out += ',' + unseen_cells(*report.unseen);
  out += part_cells(report);

  if (report.plan)
    for (const auto plan = outcome_of(*report.plan); const char* const name : {"least", "at", "first_below"})
      if (plan.contains(name)) out += ',' + csv_word(plan[name]);
  for (const auto& [what, any] : {std::pair("certain", report.plan && !report.plan->certain.empty()),
                                  {"unseen", report.plan && !report.plan->unseen.empty()}}) {
    if (!any) continue;
    const json outcome = outcome_of(*report.plan)[what];
    for (const char* const name : {"least_lower", "at"}) out += ',' + csv_word(outcome[name]);
  }
  return out + '\n';
}
