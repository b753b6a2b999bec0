// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Makes the octree of a part's cells, level by level.

#include <clearance/backends/host.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/scan/interior.hpp>

#include <algorithm>
#include <numeric>
#include <string>

namespace clearance::pointwise {

// Which primitives can be nearest in a cell, and why no other can.
//
// A primitive t is left out if a place s of another one is nearer all over the cell. Let A be the distance to t's core,
// B = |p - s|, and D by how much t's radius is larger. We need A - B > D. If D is not negative, that is A^2 > (B +
// D)^2; with A^2 - |p|^2 concave (the least of linear functions), B^2 - |p|^2 linear and B convex, the difference is
// concave, so its least value is at a corner. Otherwise (A - D)^2 > B^2 is enough, with a tangent for the A in -2 A D.

/// A cell to be looked at, and the candidates that those around it left.
struct cell_task {
  std::uint32_t x, y, z, up;   ///< See cells_view::middle.
  std::uint32_t first, count;  ///< Candidates in a list of places,
  std::uint32_t marks;         ///< one bit each, from this word on: those that are left. Of a leaf: its first entry.
  std::uint32_t node;          ///< Its own, from level `cells_view::top` on.
};

/// What is left of them.
struct cell_found {
  std::uint32_t count;
  real distance;  ///< From the cell's middle to the nearest.
};

/// The corners of a cell, a little outside of it because of rounding, and its middle.
struct cell_box {
  static constexpr int corners = 8, probes = 9;
  vec3 middle;
  real half, noise;

  /// `around`: a ball around all primitives.
  CLEARANCE_HD cell_box(const cells_view& shape, const cell_task& t, const ball& around)
      : middle(shape.middle(t.x, t.y, t.z, t.up)) {
    const real side = shape.step * real(1u << t.up),
               away = absolute(middle.x) + absolute(middle.y) + absolute(middle.z) + side;
    half = side / 2 * (1 + slack) +
           2 * slack * (away + absolute(shape.low.x) + absolute(shape.low.y) + absolute(shape.low.z));
    // Twice what rounding may change of the difference of two distances; `slack` is 32 units of it.
    noise = 2 * slack * (length(middle - around.center) + 2 * half + 2 * around.radius) + 0x1p-60f;
  }
  CLEARANCE_HD vec3 way_to(int corner) const {
    return {corner & 1 ? half : -half, corner & 2 ? half : -half, corner & 4 ? half : -half};
  }
  /// A corner, or as the last one the middle.
  CLEARANCE_HD vec3 probe(int j) const { return j < corners ? middle + way_to(j) : middle; }
};

/// Marks the candidates of task i that can be nearest in its cell.
template <class PartView>
struct mark_candidates {
  using primitive_type = typename PartView::hierarchy_type::primitive_type;
  const PartView* part;
  cells_view shape;
  const cell_task* tasks;
  const std::uint32_t* places;
  std::uint32_t* marks;
  cell_found* found;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const cell_task task = tasks[i];
    const auto* const primitives = part->tree.primitives;
    const cell_box box(shape, task, {part->facts.center, part->facts.radius});
    const auto candidate = [&](std::uint32_t n) -> primitive_type { return primitives[places[task.first + n]]; };
    real least = infinity;
    std::uint32_t nearest[cell_box::probes] = {};
    for (std::uint32_t n = 0; n < task.count; ++n)
      if (const real d = candidate(n).distance(box.middle); d < least) {
        least = d;
        nearest[cell_box::corners] = n;
      }
    // No distance changes faster than its place, so one that is far from the middle is nearest nowhere.
    const real far = least + 2 * 1.7321f * box.half + box.noise;
    real least_at[cell_box::corners];
    for (real& d : least_at) d = infinity;
    each_word(task, [&](std::uint32_t n, std::uint32_t) {
      const primitive_type p = candidate(n);
      if (!(p.distance(box.middle) <= far)) return false;
      for (int c = 0; c < cell_box::corners; ++c)
        if (const real d = p.distance(box.probe(c)); d < least_at[c]) {
          least_at[c] = d;
          nearest[c] = n;
        }
      return true;
    });
    rival rivals[cell_box::probes];
    for (int j = 0; j < cell_box::probes; ++j) rivals[j] = rival(candidate(nearest[j]).core_at(box.probe(j)), box);
    std::uint32_t left = 0;
    each_word(task, [&](std::uint32_t n, std::uint32_t near) {
      const bool may = (near >> n % 32 & 1) != 0 && may_be_nearest(candidate(n), rivals, box);
      left += may;
      return may;
    });
    found[i] = {left, least};
  }

 private:
  /// Writes a mark for each candidate. `mark(n, word)` is told what the mark's word was.
  template <class Mark>
  CLEARANCE_HD void each_word(const cell_task& task, const Mark& mark) const {
    for (std::uint32_t begin = 0; begin < task.count; begin += 32) {
      const std::uint32_t end = task.count < begin + 32 ? task.count : begin + 32,
                          before = marks[task.marks + begin / 32];
      std::uint32_t word = 0;
      for (std::uint32_t n = begin; n < end; ++n) word |= std::uint32_t(mark(n, before)) << n % 32;
      marks[task.marks + begin / 32] = word;
    }
  }
  /// A place of a core, as seen from the corners.
  struct rival {
    real away[cell_box::corners], farthest, radius;

    rival() = default;
    CLEARANCE_HD rival(const core_place& s, const cell_box& box) : farthest(0), radius(s.radius) {
      for (int c = 0; c < cell_box::corners; ++c) {
        away[c] = length(box.probe(c) - s.at);
        farthest = max(farthest, away[c]);
      }
    }
  };

  static CLEARANCE_HD bool may_be_nearest(const primitive_type& p, const rival (&rivals)[cell_box::probes],
                                          const cell_box& box) {
    const real radius = p.core_at(box.middle).radius;
    const primitive_tangent t = p.tangent_at(box.middle);
    real away[cell_box::corners];
    for (int c = 0; c < cell_box::corners; ++c) away[c] = p.distance(box.probe(c)) + radius;
    for (const rival& s : rivals) {
      const real more = radius - s.radius, of_rival = max(more, 0), its = max(-more, 0);
      const real margin = box.noise * (2 * (s.farthest + of_rival) + box.noise);
      bool nearer = true;  // the rival, everywhere
      for (int c = 0; nearer && c < cell_box::corners; ++c) {
        const real a = away[c], b = s.away[c] + of_rival,
                   plane = t.distance + dot(t.direction, box.way_to(c)) + radius - box.noise;
        nearer = (a - b) * (a + b) + its * (2 * plane + its) > margin;
      }
      if (nearer) return false;
    }
    return true;
  }
};

/// Puts the marked candidates of task i into its own list.
struct list_candidates {
  const cell_task* tasks;
  const std::uint32_t* places;
  const std::uint32_t* marks;
  const std::uint32_t* first;  ///< Where each list begins.
  std::uint32_t* lists;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const cell_task task = tasks[i];
    std::uint32_t to = first[i];
    for (std::uint32_t n = 0; n < task.count; ++n)
      if (marks[task.marks + n / 32] >> n % 32 & 1) lists[to++] = places[task.first + n];
  }
};

/// Makes the entries of leaf i, the nearest to its middle first, from its list.
template <class PartView>
struct enter_candidates {
  const PartView* part;
  cells_view shape;
  const cell_task* leaves;
  const std::uint32_t* places;
  cell_entry* entries;
  cell_kind* sides;  ///< Becomes `inside`, `list` for outside, or `unlisted` if a leaf may have both.

  CLEARANCE_HD void operator()(std::size_t i) const {
    const cell_task leaf = leaves[i];
    const cell_box box(shape, leaf, {part->facts.center, part->facts.radius});
    cell_entry* const to = entries + leaf.marks;
    real least = infinity;
    for (std::uint32_t n = 0; n < leaf.count; ++n) {
      const std::uint32_t place = places[leaf.first + n];
      const auto p = part->tree.primitives[place];
      least = min(least, p.distance(box.middle));
      const cell_entry e = entry(place, p.tangent_at(box.middle), box);
      std::uint32_t at = n;
      for (; at > 0 && to[at - 1].distance > e.distance; --at) to[at] = to[at - 1];
      to[at] = e;
    }
    sides[i] = side(box, least);
  }

 private:
  static CLEARANCE_HD cell_entry entry(std::uint32_t place, const tangent& t, const cell_box& box) {
    const auto whole = [](real u) { return std::uint16_t(rough_max(rough_min(u * 32767, 32767), -32767) + 32768.5f); };
    cell_entry e{place, 0, {whole(t.direction.x), whole(t.direction.y), whole(t.direction.z)}, 0};
    // The direction is off by less than 2/32767 along each axis, whatever rounding does.
    e.distance = t.distance - box.half * (6.0f / 32767) - slack * (absolute(t.distance) + 8 * box.half) - 0x1p-60f;
    return e;
  }
  /// All of a cell is on one side if no primitive comes nearer to it than the solid's tolerance.
  CLEARANCE_HD cell_kind side(const cell_box& box, real least) const {
    if constexpr (scan::has_interior<PartView>) {
      const real nearest = least - 1.7321f * box.half - box.noise;
      if (!(nearest > part->facts.tolerance)) return cell_kind::unlisted;
      return part->interior.inside(box.middle) ? cell_kind::inside : cell_kind::list;
    }
    return cell_kind::list;
  }
};

template <backend B, class PartView>
class cell_tree {
 public:
  static constexpr std::uint32_t most = 16;  ///< So few candidates are enough.
  static constexpr real share = 0.1f;        ///< So small a cell is, of its distance; then more candidates may be left.
  static constexpr std::uint32_t longest = 256;  ///< A longer list is none.

  /// `part` is where `on` runs.
  cell_tree(const B& on, const PartView& part, const part_facts& facts, std::size_t primitives,
            const cell_options& options)
      : on_(on),
        part_(on.copy_in(std::span<const PartView>(&part, 1))),
        bytes_(options.bytes),
        primitives_(primitives) {
    const double side = 2 * (double(facts.radius) + options.reach);
    cells_view& shape = made_.shape;
    shape.step = rounded_up(side / (1u << cells_view::deepest));
    shape.inverse = real(1 / double(shape.step));
    const real half = shape.step * real(1u << (cells_view::deepest - 1));
    shape.low = {facts.center.x - half, facts.center.y - half, facts.center.z - half};
    made_.around = {facts.center, facts.radius};
    made_.nodes.resize(cells_view::in_table);
  }

  /// Says why not if there are none.
  cells<host> make(std::string& why_not) {
    std::vector<cell_task> tasks = first_cells();
    for (std::vector<cell_task> inner;;) {
      const bool in_table = tasks[0].up >= cells_view::deepest - cells_view::top;
      std::vector<cell_found> found;
      if (quick(tasks)) found = mark(tasks);
      if (found.empty() || !fits(tasks.size(), found)) {
        if (in_table) {
          why_not = std::to_string(bytes_) + " bytes are too few for cells of its " + std::to_string(primitives_) +
                    " primitives";
          return cells<host>{};
        }
        enter(inner);
        break;
      }
      if (!in_table) link(inner, tasks);
      list(tasks, found);
      std::vector<cell_task> leaves;
      inner.clear();
      for (std::size_t i = 0; i < tasks.size(); ++i) (is_leaf(tasks[i], found[i]) ? leaves : inner).push_back(tasks[i]);
      enter(leaves);
      if (inner.empty()) break;
      tasks = children(inner);
    }
    if (unlisted_ > leaves_ / 8) {
      why_not = "its " + std::to_string(primitives_) + " primitives are too close together for cells of " +
                std::to_string(bytes_) + " bytes";
      return cells<host>{};
    }
    return std::move(made_);
  }

 private:
  static constexpr std::uint32_t first_level = 2;

  /// All cells of the first level, with all primitives.
  std::vector<cell_task> first_cells() {
    std::vector<std::uint32_t> every_primitive(primitives_);
    std::iota(every_primitive.begin(), every_primitive.end(), 0u);
    lists_ = on_.copy_in(std::span<const std::uint32_t>(every_primitive));
    constexpr std::uint32_t side = 1u << first_level;
    std::vector<cell_task> tasks;
    for (std::uint32_t c = 0; c < side * side * side; ++c)
      tasks.push_back({c % side, c / side % side, c / side / side, cells_view::deepest - first_level, 0,
                       std::uint32_t(primitives_), 0, 0});
    return tasks;
  }
  /// Eight of each cell, with its candidates.
  static std::vector<cell_task> children(const std::vector<cell_task>& cells) {
    std::vector<cell_task> tasks;
    for (const cell_task& c : cells)
      for (std::uint32_t o = 0; o < 8; ++o) {
        cell_task child{
            2 * c.x + (o & 1), 2 * c.y + (o >> 1 & 1), 2 * c.z + (o >> 2), c.up - 1, c.first, c.count, 0, 0};
        child.node = cells_view::in_table_at(child.x, child.y, child.z);  // if it is of that level
        tasks.push_back(child);
      }
    return tasks;
  }

  std::vector<cell_found> mark(std::vector<cell_task>& tasks) {
    std::uint32_t words = 0;
    for (cell_task& t : tasks) {
      t.marks = words;
      words += (t.count + 31) / 32;
    }
    tasks_ = on_.copy_in(std::span<const cell_task>(tasks));
    marks_ = on_.copy_in(std::span<const std::uint32_t>(std::vector<std::uint32_t>(words)));
    auto found = on_.template make_scratch<cell_found>(tasks.size());
    on_.for_each(tasks.size(), mark_candidates<PartView>{part_.data(), made_.shape, tasks_.data(), lists_.data(),
                                                         marks_.data(), found.data()});
    return on_.copy_out(found.data(), tasks.size());
  }
  /// Is looking at these cells worth the memory? It would not be if their lists never became shorter, as of primitives
  /// that are all equal.
  bool quick(const std::vector<cell_task>& tasks) const {
    std::uint64_t looks = 0;
    for (const cell_task& t : tasks) looks += t.count;
    return looks <= 2 * std::uint64_t(bytes_);
  }
  /// Is there room for these cells, were they all leaves, and for lists of their candidates meanwhile?
  bool fits(std::size_t cells, const std::vector<cell_found>& found) const {
    std::size_t entries = made_.entries.size(), places = 0;
    for (const cell_found& f : found) {
      entries += f.count <= longest ? f.count : 0;
      places += f.count;
    }
    return (made_.nodes.size() + cells) * sizeof(cell_node) + entries * sizeof(cell_entry) <= bytes_ &&
           places <= 4 * std::uint64_t(bytes_) && places < none;
  }
  /// Makes the cells of the last level parents of these.
  void link(const std::vector<cell_task>& inner, std::vector<cell_task>& tasks) {
    if (tasks[0].up == cells_view::deepest - cells_view::top) return;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (i % 8 == 0)
        made_.nodes[inner[i / 8].node] = {std::uint32_t(made_.nodes.size() + i), 0, cell_kind::inner, false};
      tasks[i].node = std::uint32_t(made_.nodes.size() + i);
    }
    made_.nodes.resize(made_.nodes.size() + tasks.size());
  }
  /// Gives each of these cells its own list.
  void list(std::vector<cell_task>& tasks, const std::vector<cell_found>& found) {
    std::vector<std::uint32_t> first;
    std::uint32_t total = 0;
    for (const cell_found& f : found) {
      first.push_back(total);
      total += f.count;
    }
    const auto begin = on_.copy_in(std::span<const std::uint32_t>(first));
    auto lists = on_.copy_in(std::span<const std::uint32_t>(std::vector<std::uint32_t>(total)));
    on_.for_each(tasks.size(),
                 list_candidates{tasks_.data(), lists_.data(), marks_.data(), begin.data(), lists.data()});
    on_.wait();
    lists_ = std::move(lists);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      tasks[i].first = first[i];
      tasks[i].count = found[i].count;
    }
  }
  bool is_leaf(const cell_task& t, const cell_found& f) const {
    if (t.up > cells_view::deepest - cells_view::top) return false;
    const real side = made_.shape.step * real(1u << t.up);
    return f.count <= most || t.up == 0 || (f.count <= longest && side <= share * f.distance);
  }

  /// Makes leaves of cells that have lists.
  void enter(const std::vector<cell_task>& cells) {
    std::vector<cell_task> leaves;
    std::uint32_t entries = 0;
    leaves_ += cells.size();
    for (cell_task c : cells) {
      if (c.count > longest) {
        ++unlisted_;
        continue;
      }
      c.marks = entries;
      entries += c.count;
      leaves.push_back(c);
    }
    if (leaves.empty()) return;
    const auto tasks = on_.copy_in(std::span<const cell_task>(leaves));
    auto made = on_.template make_scratch<cell_entry>(entries);
    auto sides = on_.template make_scratch<cell_kind>(leaves.size());
    on_.for_each(leaves.size(), enter_candidates<PartView>{part_.data(), made_.shape, tasks.data(), lists_.data(),
                                                           made.data(), sides.data()});
    const auto side = on_.copy_out(sides.data(), leaves.size());
    const auto before = std::uint32_t(made_.entries.size());
    for (std::size_t i = 0; i < leaves.size(); ++i)
      made_.nodes[leaves[i].node] = {before + leaves[i].marks, std::uint16_t(leaves[i].count),
                                     side[i] == cell_kind::inside ? cell_kind::inside : cell_kind::list,
                                     side[i] == cell_kind::list};
    const auto listed = on_.copy_out(made.data(), entries);
    made_.entries.insert(made_.entries.end(), listed.begin(), listed.end());
  }

  B on_;
  typename B::template buffer<PartView> part_;
  std::size_t bytes_, primitives_;
  cells<host> made_;
  typename B::template buffer<std::uint32_t> lists_, marks_;
  typename B::template buffer<cell_task> tasks_;
  std::size_t leaves_ = 0, unlisted_ = 0;
};

/// Makes the cells of one part; it says why not otherwise. Throws std::invalid_argument for a reach that cannot be.
template <backend B, class Part>
cells<host> made_cells(const B& on, const Part& part, const cell_options& options, std::string& why_not) {
  const part_facts& facts = part.facts;
  if (!(options.reach >= 0 && options.reach < 1e6))
    throw std::invalid_argument("clearance::with_cells: cells reach " + std::to_string(options.reach) +
                                " m, which must be from 0 to 1,000,000");
  constexpr std::uint64_t most = std::uint64_t(1) << 34;  // entries are numbered in 32 bits
  if (options.bytes > most) {
    why_not =
        std::to_string(options.bytes) + " bytes are too many for cells; they take at most " + std::to_string(most);
    return cells<host>{};
  }
  if (!(facts.radius > 0 && facts.radius < 1e6f && length(facts.center) < 1e6f)) {
    why_not = "a part without a finite size has no cells";
    return cells<host>{};
  }
  try {
    const auto placed_part = part.on(on);
    return cell_tree(on, placed_part.view(), facts, part.tree.primitives.size(), options).make(why_not);
  } catch (const std::exception& error) {
    if (!detail::out_of_memory(on, error)) throw;
    why_not = "there is not enough memory to make its cells";
  }
  return {};
}

}  // namespace clearance::pointwise
