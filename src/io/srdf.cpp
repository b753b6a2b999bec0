// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/srdf.hpp>

#include "io/near_word.hpp"
#include "io/note_tally.hpp"
#include "io/urdf.hpp"
#include "io/xml.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

namespace {

/// The elements of SRDF that say which pairs can meet, in the order in which MoveIt applies them.
constexpr std::array<std::string_view, 3> srdf_rules{"disable_default_collisions", "enable_collisions",
                                                     "disable_collisions"};
/// Those that say nothing about it.
constexpr std::string_view srdf_others =
    "group group_state end_effector virtual_joint passive_joint joint_property link_sphere_approximation";

/// Finds the parts that an SRDF file names by their links.
class named_parts {
 public:
  explicit named_parts(const robot& described) {
    for (const std::string& link : described.kinematics().links()) parts_.emplace(link, std::nullopt);
    for (std::size_t k = 0; k < described.parts().size(); ++k) parts_[described.parts()[k].name] = k;
  }

  /// Of a link without geometry there is none, nor of one that the robot lacks or the element does not name, which is
  /// noted; `enable_collisions` must name it, because a pair without a rule may be lost.
  std::optional<std::size_t> operator()(const xml_place& at, std::string_view attribute, note_tally& notes) const {
    const std::string* value = at.element.attribute(attribute);
    std::string_view link = value ? std::string_view(*value) : std::string_view();
    link.remove_prefix(std::min(link.find_first_not_of(blanks), link.size()));
    link = link.substr(0, link.find_last_not_of(blanks) + 1);
    if (link.empty()) {
      const std::string why = "does not say which link is its " + std::string(attribute);
      if (at.element.name == srdf_rules[1]) at.refuse(why);
      notes.add(why + ", and is passed over", "<" + at.element.name + ">", at.element.line);
      return std::nullopt;
    }
    const auto found = parts_.find(link);
    if (found != parts_.end()) return found->second;
    notes.add("is named in the SRDF file, and is no link of the robot", "link " + io::quoted(link), at.element.line);
    return std::nullopt;
  }

 private:
  static constexpr std::string_view blanks = " \t\r\n";
  std::map<std::string, std::optional<std::size_t>, std::less<>> parts_;
};

/// Refuses an element that may be a rule, misspelt; notes another that SRDF does not have.
void judge_srdf_word(const xml_place& at, note_tally& notes) {
  const std::string& name = at.element.name;
  if (std::ranges::find(srdf_rules, name) != srdf_rules.end() || has_word(srdf_others, name)) return;
  if (name.starts_with("xacro:")) at.refuse("is xacro: expand it with xacro first");
  for (const std::string_view rule : srdf_rules)
    if (near_word(name, rule)) at.refuse("is not known (" + std::string(rule) + "?)");
  notes.add("is not known in SRDF, and is passed over", "<" + name.substr(0, 60) + ">", at.element.line);
}

}  // namespace

part_pairs pairs_without_neighbours(const robot& described) {
  const kinematic_tree& tree = described.kinematics();
  std::map<std::string, std::size_t> parts;
  for (std::size_t k = 0; k < described.parts().size(); ++k) parts[described.parts()[k].name] = k;

  part_pairs pairs(described.parts().size());
  std::map<std::string, std::vector<std::size_t>> held;  // parts, by the link that fixed joints hold them to
  for (const auto& [name, k] : parts) {
    std::size_t link = described.parts()[k].link, slides = 0;
    std::optional<std::size_t> above;
    bool fixed = true;
    std::string root = name;
    while (tree.joint_above(link) != kinematic_tree::none) {
      const joint& by = tree.joints()[tree.joint_above(link)];
      slides += by.kind == joint_kind::prismatic && !above;
      fixed = fixed && by.kind == joint_kind::fixed;
      if (fixed) root = by.parent;
      if (const auto at = parts.find(by.parent); !above && at != parts.end()) above = at->second;
      if (above && !fixed) break;
      link = tree.link(by.parent);
    }
    if (above && slides < 2) pairs.remove(k, *above);
    for (const std::size_t other : held[root]) pairs.remove(k, other);
    held[root].push_back(k);
  }
  return pairs;
}

void remove_pairs_of_held(part_pairs& pairs, const robot& described, std::span<const std::size_t> held) {
  const part_pairs apart = pairs_without_neighbours(described);
  for (const std::size_t k : held)
    for (std::size_t other = 0; other < apart.parts(); ++other)
      if (other != k && !apart.has(k, other)) pairs.remove(k, other);
}

srdf_pairs load_srdf(const std::filesystem::path& srdf, const robot& described, const mesh_limits& limits) {
  const std::string file = srdf.string();
  return load_srdf_text(read_bytes(file, {.piped = limits.bytes}), file, described, limits);
}

srdf_pairs load_srdf_text(std::string_view text, const std::string& name, const robot& described,
                          const mesh_limits& limits) {
  if (text.size() > limits.bytes)
    refuse(name, "is longer than the limit of " + std::to_string(limits.bytes) + " bytes (mesh_limits::bytes)");
  const xml_element root = within_memory(
      name, [&] { return read_xml(text.substr(declaration_after_blanks(text)), name, limits, xml_prefixes::any); });
  if (root.name != "robot") refuse(name, "is not an SRDF file: it has no element robot", root.line);
  const xml_place robot_place{root, name, ""};
  robot_place.no_text();

  note_tally notes;
  if (const std::string* of = root.attribute("name"); of && *of != described.name())
    notes.add("is that of another robot, " + io::quoted(*of) + ", not of " + io::quoted(described.name()),
              "the SRDF file", root.line);
  for (const auto& child : root.children) {
    if (child.name == "link" || child.name == "joint")
      refuse(name, "is a URDF file, not its SRDF: it has a <" + child.name + ">", child.line);
    judge_srdf_word(robot_place.in(child), notes);
  }

  const named_parts part(described);
  part_pairs pairs(described.parts().size());
  for (const std::string_view rule : srdf_rules)
    for (const auto& child : root.children) {
      if (child.name != rule) continue;
      const xml_place at = robot_place.in(child);
      if (rule == srdf_rules[0]) {
        const auto off = part(at, "link", notes);
        for (std::size_t other = 0; off && other < pairs.parts(); ++other)
          if (other != *off) pairs.remove(*off, other);
        continue;
      }
      const auto a = part(at, "link1", notes), b = part(at, "link2", notes);
      if (!a || !b) continue;
      if (*a == *b)
        notes.add("is named with itself, which says nothing", "link " + io::quoted(described.parts()[*a].name),
                  child.line);
      else
        pairs.set(*a, *b, rule == "enable_collisions");
    }
  const std::size_t parts = pairs.parts();
  if (pairs.size() == parts * (parts - 1) / 2 && parts > 1)
    notes.add("disables no pair of parts, so neighbours are asked about, too", "the SRDF file");
  return {std::move(pairs), notes.sentences()};
}

}  // namespace clearance::io
