// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Damages a document in every way of a family, one at a time, and says which outcomes are allowed.

#include "io/robot_folder.hpp"
#include "io/xml_text.hpp"
#include "support/catch.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// What a reader made of a document: its answer in words, or the sentence with which it refused.
struct outcome {
  std::string answer, refusal;
};

/// One damage: what was done, the document, in whose link or joint, and whether another answer is explained by it.
struct damaged {
  std::string what, text, owner;
  bool explained = false;
};

inline void check_sentence(const std::string& text, const std::string& file) {
  CHECK(text.starts_with(file));
  CHECK(text.size() <= 400);
  for (const char c : text)
    if (static_cast<unsigned char>(c) < ' ') FAIL("a control character in: " << text);
}

/// Every element of a document in order, with the link or joint that it is in.
inline void each_element(clearance::io::xml_element& e, const std::string& owner,
                         const std::function<void(clearance::io::xml_element&, const std::string&)>& visit) {
  const std::string* name = e.attribute("name");
  const std::string within = (e.name == "link" || e.name == "joint") && owner.empty() && name ? *name : owner;
  visit(e, within);
  for (auto& child : e.children) each_element(child, within, visit);
}

/// Every word of an attribute or text replaced by every one of `words`.
inline std::vector<std::string> words_damaged(const std::string& text, const std::vector<std::string>& words) {
  std::vector<std::string> made;
  constexpr std::string_view blank = " \t\r\n";
  for (std::size_t at = text.find_first_not_of(blank); at != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(blank, at), text.size());
    for (const auto& word : words) made.push_back(text.substr(0, at) + word + text.substr(end));
    at = text.find_first_not_of(blank, end);
  }
  return made;
}

inline bool one_of(const std::string& name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// All elements of a document left out, renamed or doubled; all its attributes left out or renamed. `may_go` and
/// `may_repeat` say which elements a document may have or not have; `optional`, which attributes.
inline std::vector<damaged> structure_damages(const std::string& text, std::initializer_list<std::string_view> may_go,
                                              std::initializer_list<std::string_view> may_repeat,
                                              std::initializer_list<std::string_view> optional) {
  using clearance::io::xml_element;
  std::vector<damaged> made;
  xml_element root = clearance::io::read_xml(text, "seed");
  const auto add = [&](const std::string& what, const std::string& owner, bool explained) {
    made.push_back({what, xml_text(root), owner, explained});
  };
  each_element(root, "", [&](xml_element& e, const std::string& owner) {
    for (std::size_t i = 0; i < e.attributes.size(); ++i) {
      const auto kept = e.attributes;
      const std::string what = e.name + "." + kept[i].first;
      e.attributes.erase(e.attributes.begin() + std::ptrdiff_t(i));
      const std::string named = kept[i].first == "name" ? "" : owner;
      add(what + " left out", named, one_of(kept[i].first, optional));
      e.attributes = kept;
      e.attributes[i].first += "x";
      add(what + " renamed", named, false);
      e.attributes = kept;
    }
    for (std::size_t i = 0; i < e.children.size(); ++i) {
      const auto kept = e.children;
      const std::string name = kept[i].name;
      e.children.erase(e.children.begin() + std::ptrdiff_t(i));
      add(name + " left out", "", one_of(name, may_go));
      e.children = kept;
      e.children[i].name += "x";
      add(name + " renamed", "", false);
      e.children = kept;
      e.children.insert(e.children.begin() + std::ptrdiff_t(i), kept[i]);
      add(name + " doubled", "", one_of(name, may_repeat));
      e.children = kept;
    }
  });
  return made;
}

/// Runs all damages through a reader: each must give the same answer as the undamaged document, or a refusal in one
/// sentence that names its link or joint, or, if it is explained, another answer.
inline void check_damages(const std::vector<damaged>& all, const std::string& undamaged, const std::string& file,
                          const std::function<outcome(const std::string&)>& read) {
  const outcome whole = read(undamaged);
  REQUIRE(whole.refusal.empty());
  std::size_t refused = 0, same = 0, explained = 0;
  for (const damaged& each : all) {
    const outcome made = read(each.text);
    INFO(each.what << " -> " << made.refusal << made.answer.substr(0, 300));
    if (!made.refusal.empty()) {
      ++refused;
      check_sentence(made.refusal, file);
      if (!each.owner.empty() && !says(made.refusal, '"' + each.owner + '"')) FAIL("it does not name " << each.owner);
    } else if (made.answer == whole.answer) {
      ++same;
    } else if (each.explained) {
      ++explained;
    } else {
      FAIL("another answer, without a word");
    }
  }
  CHECK(refused > 0);
  WARN(all.size() << " damages: " << refused << " refused, " << same << " without effect, " << explained
                  << " with an answer that they explain");
}
