// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a model can beyond what its concept demands, as a list of names. C++20 cannot list a type's members, so a
// misspelt optional member would be silently absent; with the list it is missed.

#include <type_traits>

namespace clearance {

/// `using can = clearance::can<merging, partial>;` in a question, an answer or a point source: the abilities that it
/// means to have. An ability without its member is refused then, and so is a member without its ability.
template <class... Abilities>
struct can {
  template <class Ability>
  static constexpr bool has = (std::is_same_v<Ability, Abilities> || ...);
  template <class... Known>
  static constexpr bool all_of = (can<Known...>::template has<Abilities> && ...);
};

/// Does the model M list what it can, and is this ability in its list?
template <class M>
inline constexpr bool has_list = requires { typename M::can; };
template <class M, class Ability>
inline constexpr bool lists = false;
template <class M, class Ability>
  requires has_list<M>
inline constexpr bool lists<M, Ability> = M::can::template has<Ability>;

/// Explains each ability that models of a kind may have. Another one in the list is refused.
template <class M, class... Known>
consteval bool explain_abilities() {
  if constexpr (has_list<M>)
    static_assert(M::can::template all_of<Known...>,
                  "the list can<...> names an ability that models of this kind do not have");
  return (Known::template explain<M>() && ...);
}

/// The body of a struct about a member that models are asked for by its name. `is_there`: has M such a member, of
/// whatever kind? (A final class is not asked.) `needs` says SENTENCE, what the member must be, unless it is so.
#define CLEARANCE_MEMBER(MEMBER, SENTENCE)                                   \
  struct also {                                                              \
    int MEMBER;                                                              \
  };                                                                         \
  template <class M>                                                         \
  struct both : M, also {};                                                  \
  template <class M>                                                         \
  static consteval bool is_there() {                                         \
    if constexpr (std::is_class_v<M> && !std::is_final_v<M>)                 \
      return !requires { &both<M>::MEMBER; }; /* of two, neither is meant */ \
    else                                                                     \
      return false;                                                          \
  }                                                                          \
  template <bool IsSo>                                                       \
  static consteval bool needs() {                                            \
    static_assert(IsSo, SENTENCE);                                           \
    return IsSo;                                                             \
  }

/// Declares an ability, which is a type: who has the member, or lists the ability, must have the member and fit
/// CONCEPT.
#define CLEARANCE_ABILITY(NAME, MEMBER, CONCEPT, SENTENCE)                                        \
  struct NAME {                                                                                   \
    CLEARANCE_MEMBER(MEMBER, SENTENCE)                                                            \
    template <class M>                                                                            \
    static consteval bool explain() {                                                             \
      constexpr bool listed = lists<M, NAME>, there = is_there<M>();                              \
      static_assert(listed || !there || !has_list<M>,                                             \
                    "there is a member " #MEMBER ", but the list can<...> does not name " #NAME); \
      return needs<!(there || listed) || (CONCEPT<M> && (there || std::is_final_v<M>))>();        \
    }                                                                                             \
  }

}  // namespace clearance
