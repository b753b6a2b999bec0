// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is a word that a format does not define a misspelt one, or one that would change the answer?

#include <clearance/io/cloud_text.hpp>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

inline std::string lower_case(std::string_view word) {
  std::string made(word);
  for (char& c : made) c = char(std::tolower(static_cast<unsigned char>(c)));
  return made;
}

/// The number of letters to insert, drop, change, or swap with their neighbour to make one word the other.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

/// Is the edit distance 1? Takes time in proportion to the words' length.
inline bool one_letter_off(std::string_view a, std::string_view b) {
  const auto same = std::size_t(std::ranges::mismatch(a, b).in1 - a.begin());
  a.remove_prefix(same);
  b.remove_prefix(same);
  while (!a.empty() && !b.empty() && a.back() == b.back()) {
    a.remove_suffix(1);
    b.remove_suffix(1);
  }
  return std::max(a.size(), b.size()) == 1 || (a.size() == 2 && b.size() == 2 && a[0] == b[1] && a[1] == b[0]);
}

/// May a word be a misspelling of another? Yes with up to two wrong letters, or one if the known word has four letters
/// or fewer; case does not matter.
inline bool near_word(std::string_view word, std::string_view known) {
  const std::size_t wrong = known.size() > 4 ? 2 : 1;
  return word.size() <= known.size() + wrong && known.size() <= word.size() + wrong &&
         edit_distance(lower_case(word), lower_case(known)) <= wrong;
}

/// Words that say where something is, or how large: whatever has them as words of a name would change the answer if it
/// means what it says. One list for all formats.
inline constexpr std::string_view placing =
    "pose transform translation rotation position orientation quaternion quat quat_xyzw wxyz";
inline constexpr std::string_view sizing = "scale scaling unit units offset";

/// The first of the words for which `holds`, or nothing. Blanks separate words.
template <class Holds>
std::string_view first_word(std::string_view words, Holds holds) {
  for (std::string_view word; !(word = take_word(words, " ")).empty();)
    if (holds(word)) return word;
  return {};
}
inline bool has_word(std::string_view words, std::string_view wanted) {
  return !first_word(words, [&](std::string_view word) { return word == wanted; }).empty();
}

/// Why a reader must refuse a name that its format does not define; empty if the name cannot change the answer.
/// `known`: the format's own words there.
inline std::string risk_of(std::string_view name, std::string_view known) {
  const std::string_view meant = first_word(known, [&](std::string_view word) { return near_word(name, word); });
  if (!meant.empty()) return "is not known (" + std::string(meant) + "?)";
  std::string small = lower_case(name);
  for (char& c : small)
    if (c == '_' || c == '-' || c == '.') c = ' ';
  const auto changes = [&](std::string_view word) {
    return has_word(placing, word) || has_word(sizing, word) || has_word("buffer padding margin inflation frame", word);
  };
  return first_word(small, changes).empty() ? "" : "is not known, and may change the answer";
}

}  // namespace clearance::io
