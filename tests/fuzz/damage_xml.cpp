// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"
#include "io/xml_text.hpp"

namespace fuzz {

using element = clearance::io::xml_element;

namespace {

void all_of(element& e, std::vector<element*>& made) {
  made.push_back(&e);
  for (auto& child : e.children) all_of(child, made);
}

const char* const words[] = {"",
                             "0",
                             "-0",
                             "1",
                             "-1",
                             "0.5",
                             "1e-9",
                             "1e9",
                             "1e300",
                             "1e-320",
                             "nan",
                             "-inf",
                             "1e999",
                             "0x10",
                             "1,5",
                             "1 2 3",
                             "0 0 0",
                             "0 0 1",
                             "1 1",
                             "1 1 1",
                             "2147483648",
                             "4294967296",
                             "18446744073709551616",
                             "a",
                             "#a",
                             "base",
                             "world",
                             "fixed",
                             "revolute",
                             "m.stl",
                             "given",
                             "package://p/m.stl",
                             "file://m.stl",
                             "X",
                             "VERTEX"};

template <class All>
auto& one_of(All& all, std::mt19937& random) {
  return all[random() % std::size(all)];
}

/// One change of the tree. New names, values and elements are mostly others of the document.
void change(element& root, std::mt19937& random) {
  std::vector<element*> all;
  all_of(root, all);
  element& e = *one_of(all, random);
  const element copy = *one_of(all, random);
  const auto at = [&](const auto& list) { return std::ptrdiff_t(random() % list.size()); };
  switch (random() % 10) {
    case 0:
      if (!e.children.empty()) e.children.erase(e.children.begin() + at(e.children));
      break;
    case 1:
      if (all.size() < 300)
        e.children.insert(e.children.begin() + std::ptrdiff_t(random() % (e.children.size() + 1)), copy);
      break;
    case 2:
      if (!e.children.empty()) std::swap(one_of(e.children, random), one_of(e.children, random));
      break;
    case 3:
      e.name = copy.name;
      break;
    case 4:
      if (!e.attributes.empty()) e.attributes.erase(e.attributes.begin() + at(e.attributes));
      break;
    case 5:
      for (const auto& [key, value] : copy.attributes)
        if (!e.attribute(key)) e.attributes.emplace_back(key, value);
      break;
    case 6:
      e.text = random() % 2 ? copy.text : any_damage(e.text);
      break;
    default:  // a value, or a word in it
      if (e.attributes.empty()) return;
      std::string& value = one_of(e.attributes, random).second;
      if (const auto kind = random() % 4; kind == 0) {
        value = any_damage(value);
      } else if (kind == 1 && !copy.attributes.empty()) {
        value = copy.attributes[random() % copy.attributes.size()].second;
      } else {
        const std::size_t blank = value.find(' ', random() % (value.size() + 1));
        value = (kind == 2 && blank != value.npos ? value.substr(0, blank + 1) : "") + one_of(words, random);
      }
  }
}

}  // namespace

bytes damage_xml(bytes input, std::mt19937& random) {
  const std::size_t end = std::min(input.find('\0'), input.size());
  if (end < input.size() && random() % 4 == 0) return input.substr(0, end + 1) + any_damage(input.substr(end + 1));
  element root;
  try {
    root =
        clearance::io::read_xml(std::string_view(input).substr(0, end), "", meshes, clearance::io::xml_prefixes::any);
  } catch (const std::runtime_error&) {
    return any_damage(input);
  }
  for (auto changes = 1 + random() % 3; changes > 0; --changes) change(root, random);
  return xml_text(root) + input.substr(end);
}

}  // namespace fuzz
