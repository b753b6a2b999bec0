// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Decides what may stand where in a URDF file, and what happens to everything else. What may change the answer is
// refused; what cannot is noted.

#include "io/near_word.hpp"
#include "io/note_tally.hpp"
#include "io/xml.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// What an element may hold: words separated by blanks.
struct urdf_words {
  std::string_view element;
  std::string_view attributes = {};         ///< Attributes that are read.
  std::string_view attributes_unused = {};  ///< Attributes that URDF defines, and nobody reads.
  std::string_view children = {};           ///< Elements that are read.
  std::string_view children_unused = {};    ///< Elements that URDF defines, and nobody reads. None may contain a shape.
  /// Other elements that are common, whatever they resemble; a bare <geometry> may be in them.
  std::string_view children_noted = {};
  /// Refused, as attribute or element: they would change the answer if they meant what they say. So are words of sizes,
  /// everywhere.
  std::string_view watched = {};
  bool places = false;  ///< The element says where something is, or how large: refuses whatever resembles its words.
};

inline constexpr urdf_words urdf_vocabulary[] = {
    {.element = "robot",
     .attributes = "name",
     .attributes_unused = "version",
     .children = "link joint",
     .children_unused = "material transmission gazebo sensor ros2_control",
     .watched = "include macro robot"},
    {.element = "link",
     .attributes = "name",
     .attributes_unused = "type",
     .children = "visual collision",
     .children_unused = "inertial contact sensor",
     .children_noted = "self_collision_checking collision_checking self_filter origin",
     .watched = "include"},
    {.element = "visual",
     .attributes_unused = "name group",
     .children = "origin geometry",
     .children_unused = "material contact_coefficients verbose",
     .watched = placing},
    {.element = "collision",
     .attributes_unused = "name group",
     .children = "origin geometry",
     .children_unused = "material contact_coefficients verbose",
     .watched = placing},
    {.element = "geometry",
     .attributes_unused = "name",
     .children = "box sphere cylinder capsule mesh",
     .watched = "origin"},
    {.element = "origin",
     .attributes = "xyz rpy",
     .watched = "pose quat quat_xyzw quaternion wxyz rotation translation position orientation x y z roll pitch yaw",
     .places = true},
    {.element = "box", .attributes = "size", .watched = "origin", .places = true},
    {.element = "sphere", .attributes = "radius", .watched = "origin", .places = true},
    {.element = "cylinder", .attributes = "radius length", .watched = "origin", .places = true},
    {.element = "capsule", .attributes = "radius length", .watched = "origin", .places = true},
    {.element = "mesh", .attributes = "filename scale", .watched = "origin", .places = true},
    {.element = "joint",
     .attributes = "name type",
     .children = "origin parent child axis limit mimic",
     .children_unused = "dynamics calibration safety_controller disable_collision",
     .watched = placing},
    {.element = "parent", .attributes = "link", .watched = "origin", .places = true},
    {.element = "child", .attributes = "link", .watched = "origin", .places = true},
    {.element = "axis", .attributes = "xyz", .watched = "origin", .places = true},
    {.element = "limit",
     .attributes = "lower upper",
     .attributes_unused = "effort velocity acceleration deceleration jerk power"},
    {.element = "mimic", .attributes = "joint multiplier offset"},
};
/// Refused wherever they do not belong.
inline constexpr std::string_view urdf_parts = "link joint visual collision geometry";
/// An element has at most one of these.
inline constexpr std::string_view urdf_single = "origin geometry parent child axis limit mimic";
/// An element with one of these in its name may hide geometry that is meant.
inline constexpr std::string_view urdf_shapely = "visual collision geometry";

inline std::string_view local_name(std::string_view name) { return name.substr(name.find(':') + 1); }

/// The words that a name may be, misspelt or with a prefix.
inline std::string_view meant_by(std::string_view name, std::string_view words) {
  return first_word(words,
                    [&](std::string_view word) { return near_word(name, word) || near_word(local_name(name), word); });
}

/// Is there an element with one of these names in another, at any depth?
inline bool holds_any(const xml_element& element, std::string_view words) {
  return std::ranges::any_of(element.children, [&](const xml_element& child) {
    return has_word(words, local_name(child.name)) || holds_any(child, words);
  });
}
/// Is there a link or joint in an element, and not only its name?
inline bool holds_robot(const xml_element& element) {
  return std::ranges::any_of(element.children, [](const xml_element& child) {
    const auto has = [&](const char* name) {
      return std::ranges::any_of(child.children, [&](const auto& e) { return e.name == name; });
    };
    return child.name == "link" || (child.name == "joint" && has("parent") && has("child")) || holds_robot(child);
  });
}

/// Judges a whole file by its words, before anything else reads it.
class urdf_judge {
 public:
  urdf_judge(const std::string& file, note_tally& notes) : file_(file), notes_(notes) {}

  void judge(const xml_element& robot) {
    open_ = {&robot};
    enter({robot, file_, ""}, true);
  }

 private:
  /// `known`: URDF has this element in this place.
  void enter(const xml_place& at, bool known) {
    const auto words = std::ranges::find(urdf_vocabulary, at.element.name, &urdf_words::element);
    const bool judged = known && words != std::end(urdf_vocabulary);
    if (judged) {
      attributes(at, *words);
      text(at, words->places);
    }
    for (const xml_element& child : at.element.children) {
      const std::string* name = child.attribute("name");
      const bool part = at.owner.empty() && name && (child.name == "link" || child.name == "joint");
      open_.push_back(&child);
      refuse_xacro(child);
      const xml_place inner{child, file_, part ? child.name + " " + io::quoted(*name) : at.owner};
      const bool read = judged && element(at, inner, *words);
      if (read && has_word(urdf_single, child.name) &&
          std::any_of(at.element.children.data(), &child, [&](const auto& e) { return e.name == child.name; }))
        note(inner, "is there twice, the same both times");  // if they differ, the reader refuses them
      enter(inner, read);
      open_.pop_back();
    }
  }

  static bool watched(const urdf_words& words, std::string_view name) {
    const std::string small = lower_case(local_name(name));
    return has_word(words.watched, small) || has_word(sizing, small);
  }

  void attributes(const xml_place& at, const urdf_words& words) {
    for (const auto& [name, value] : at.element.attributes) {
      if (has_word(words.attributes, name) || has_word(words.attributes_unused, name) || name == "xmlns" ||
          name.starts_with("xmlns:") || name.starts_with("xml:"))
        continue;
      // Not for name and type: their readers notice if one is missing.
      const auto matters = [](std::string_view word) { return word != "name" && word != "type"; };
      const std::string_view meant = first_word(words.attributes, [&](std::string_view word) {
        return matters(word) &&
               (!meant_by(name, word).empty() || (words.places && lower_case(name).find(word) != name.npos));
      });
      if (!meant.empty() || watched(words, name))
        at.refuse("has an attribute " + io::quoted(name) + ", which is not known" +
                  (meant.empty() ? "" : " (" + std::string(meant) + "?)"));
      if (!of_others(name))
        note(at, "has an attribute " + io::quoted(name) + ", which is not known, and is passed over");
    }
  }

  /// Is this child to be read? If it is unknown, notes or refuses it.
  bool element(const xml_place& at, const xml_place& child, const urdf_words& words) {
    const std::string& name = child.element.name;
    if (has_word(words.children, name)) return true;
    if (has_word(words.children_unused, name)) {
      if (name != "gazebo" && holds_any(child.element, urdf_shapely))
        child.refuse("has a shape in it, which belongs elsewhere");
      return false;
    }

    const bool shapes = holds_any(child.element, "visual collision geometry box sphere cylinder capsule mesh");
    const std::string where = "is not known in <" + at.element.name + ">";
    if (has_word(words.children_noted, name)) {
      if (holds_any(child.element, "visual collision")) child.refuse("has a shape in it, which belongs elsewhere");
    } else {
      std::string_view meant = meant_by(name, words.children);
      if (meant.empty()) meant = meant_by(name, urdf_parts);
      if (meant.empty())
        meant = first_word(words.attributes, [&](auto word) {
          return word != "name" && word != "type" && !meant_by(name, word).empty();
        });
      if (meant.empty() && shapes)
        meant =
            first_word(urdf_shapely, [&](std::string_view word) { return lower_case(name).find(word) != name.npos; });
      if (!meant.empty()) child.refuse(where + (meant == name ? "" : " (" + std::string(meant) + "?)"));
      if (watched(words, name)) child.refuse(where + ", and may change the answer");
      if (holds_robot(child.element)) child.refuse(where + ", and has a part of a robot in it");
      if (of_others(name) && !shapes) return false;
    }
    note(child, where + ", and is passed over" + (shapes ? ": the geometry in it is not used" : ""));
    return false;
  }

  /// Text beside elements is a remark, unless it looks like an element.
  void text(const xml_place& at, bool places) {
    const std::string& all = at.element.text;
    const auto begin = all.find_first_not_of(" \t\r\n");
    if (begin == all.npos) return;
    std::string bare;
    for (const char c : all)
      if (std::string_view(" \t\r\n").find(c) == std::string_view::npos) bare += c;
    const bool element = bare.find("=\"") != bare.npos || bare.find("='") != bare.npos || bare.find('<') != bare.npos ||
                         bare.find("!--") != bare.npos;
    if (places || element) at.no_text();
    note(at, "has text in it, which is passed over");
  }

  void note(const xml_place& at, const std::string& what) {
    notes_.add("<" + at.element.name.substr(0, 60) + "> " + what,
               at.owner.empty() ? "line " + std::to_string(at.element.line) : at.owner, at.element.line);
  }

  /// The vocabulary of a name's prefix; no value if the prefix is not declared.
  std::optional<std::string_view> vocabulary(std::string_view name) const {
    const std::string declared = "xmlns:" + std::string(name.substr(0, name.find(':')));
    for (auto at = open_.rbegin(); at != open_.rend(); ++at)
      if (const std::string* found = (*at)->attribute(declared)) return *found;
    return {};
  }
  /// Names of a declared other vocabulary are not ours to judge.
  bool of_others(std::string_view name) const { return name.find(':') != name.npos && vocabulary(name); }

  void refuse_xacro(const xml_element& element) const {
    if (element.name.find(':') == element.name.npos) return;
    const auto of = vocabulary(element.name);
    if (element.name.starts_with("xacro:") || (of && lower_case(*of).find("xacro") != of->npos))
      refuse(file_, "has xacro in it: expand it with xacro first", element.line);
  }

  const std::string& file_;
  note_tally& notes_;
  std::vector<const xml_element*> open_;  // from the root to the current one
};

}  // namespace clearance::io
