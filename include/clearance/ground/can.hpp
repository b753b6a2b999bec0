// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a model can beyond what its concept demands, as a list of names. C++20 cannot list a type's members, so that a
// misspelt optional member would be silently absent; in the list its ability is missed.

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

/// Refuses abilities that are none of `Known`, and explains each of these.
template <class M, class... Known>
consteval bool explain_abilities() {
  if constexpr (has_list<M>)
    static_assert(M::can::template all_of<Known...>,
                  "the list can<...> names an ability that models of this kind do not have");
  return (Known::template explain<M>() && ...);
}

/// Declares an ability: a model that has a member of this name, of whatever kind, must fit CONCEPT, and so must one
/// that lists the ability. SENTENCE says what the member is. (A final class is not asked for names.)
#define CLEARANCE_ABILITY(NAME, MEMBER, CONCEPT, SENTENCE)                                                    \
  struct NAME {                                                                                               \
    struct also {                                                                                             \
      int MEMBER;                                                                                             \
    };                                                                                                        \
    template <class M>                                                                                        \
    struct both : M, also {};                                                                                 \
    template <class M>                                                                                        \
    static consteval bool is_there() {                                                                        \
      if constexpr (std::is_class_v<M> && !std::is_final_v<M>)                                                \
        return !requires { &both<M>::MEMBER; }; /* of two, neither is meant */                                \
      else                                                                                                    \
        return CONCEPT<M>;                                                                                    \
    }                                                                                                         \
    template <class M>                                                                                        \
    static consteval bool explain() {                                                                         \
      static_assert(CONCEPT<M> || !(is_there<M>() || lists<M, NAME>), SENTENCE);                              \
      static_assert(lists<M, NAME> || !(is_there<M>() && has_list<M>),                                        \
                    "there is a member " #MEMBER ", but the list can<...> does not name the ability " #NAME); \
      return true;                                                                                            \
    }                                                                                                         \
  }

}  // namespace clearance
