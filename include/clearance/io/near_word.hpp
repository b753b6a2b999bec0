// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
  a.remove_prefix(same), b.remove_prefix(same);
  while (!a.empty() && !b.empty() && a.back() == b.back()) a.remove_suffix(1), b.remove_suffix(1);
  return std::max(a.size(), b.size()) == 1 || (a.size() == 2 && b.size() == 2 && a[0] == b[1] && a[1] == b[0]);
}

/// May a word be a misspelling of another? Yes with up to two wrong letters, or one if the known word has four letters
/// or fewer; case does not matter.
inline bool near_word(std::string_view word, std::string_view known) {
  const std::size_t wrong = known.size() > 4 ? 2 : 1;
  return word.size() <= known.size() + wrong && known.size() <= word.size() + wrong &&
         edit_distance(lower_case(word), lower_case(known)) <= wrong;
}

}  // namespace clearance::io
