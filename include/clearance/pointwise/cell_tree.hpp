// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Makes the octree of a part's cells, level by level.

#include <clearance/backend/host.hpp>
#include <clearance/pointwise/cell_lists.hpp>
#include <clearance/result.hpp>

#include <algorithm>
#include <numeric>
#include <string>

namespace clearance {

struct cell_options {
  std::size_t bytes = std::size_t(64) << 20;  ///< Memory for each part, at most; up to 16 GiB.
  double reach = 4;                           ///< Metres around a part's ball that its cells cover.
};

namespace pointwise {

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
    shape.step = rounded_up(side / (1u << cells_view::deepest)), shape.inverse = real(1 / double(shape.step));
    const real half = shape.step * real(1u << (cells_view::deepest - 1));
    shape.low = {facts.center.x - half, facts.center.y - half, facts.center.z - half};
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
        if (in_table)
          return why_not = std::to_string(bytes_) + " bytes are too few for cells of its " +
                           std::to_string(primitives_) + " primitives",
                 cells<host>{};
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
    if (unlisted_ > leaves_ / 8)
      return why_not = "its " + std::to_string(primitives_) + " primitives are too close together for cells of " +
                       std::to_string(bytes_) + " bytes",
             cells<host>{};
    return std::move(made_);
  }

 private:
  static constexpr std::uint32_t first_level = 2;

  /// All cells of the first level, with all primitives.
  std::vector<cell_task> first_cells() {
    std::vector<std::uint32_t> all(primitives_);
    std::iota(all.begin(), all.end(), 0u);
    lists_ = on_.copy_in(std::span<const std::uint32_t>(all));
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
    for (cell_task& t : tasks) t.marks = words, words += (t.count + 31) / 32;
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
    for (const cell_found& f : found) entries += f.count <= longest ? f.count : 0, places += f.count;
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
    std::uint32_t all = 0;
    for (const cell_found& f : found) first.push_back(all), all += f.count;
    const auto begin = on_.copy_in(std::span<const std::uint32_t>(first));
    auto lists = on_.copy_in(std::span<const std::uint32_t>(std::vector<std::uint32_t>(all)));
    on_.for_each(tasks.size(),
                 list_candidates{tasks_.data(), lists_.data(), marks_.data(), begin.data(), lists.data()});
    on_.wait();
    lists_ = std::move(lists);
    for (std::size_t i = 0; i < tasks.size(); ++i) tasks[i].first = first[i], tasks[i].count = found[i].count;
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
      c.marks = entries, entries += c.count;
      leaves.push_back(c);
    }
    if (leaves.empty()) return;
    const auto there = on_.copy_in(std::span<const cell_task>(leaves));
    auto made = on_.template make_scratch<cell_entry>(entries);
    auto sides = on_.template make_scratch<cell_kind>(leaves.size());
    on_.for_each(leaves.size(), enter_candidates<PartView>{part_.data(), made_.shape, there.data(), lists_.data(),
                                                           made.data(), sides.data()});
    const auto side = on_.copy_out(sides.data(), leaves.size());
    const auto before = std::uint32_t(made_.entries.size());
    for (std::size_t i = 0; i < leaves.size(); ++i)
      made_.nodes[leaves[i].node] = {before + leaves[i].marks, std::uint16_t(leaves[i].count),
                                     side[i] == cell_kind::inside ? cell_kind::inside : cell_kind::list,
                                     side[i] == cell_kind::list};
    const auto its = on_.copy_out(made.data(), entries);
    made_.entries.insert(made_.entries.end(), its.begin(), its.end());
  }

  B on_;
  typename B::template buffer<PartView> part_;
  std::size_t bytes_, primitives_;
  cells<host> made_;
  typename B::template buffer<std::uint32_t> lists_, marks_;
  typename B::template buffer<cell_task> tasks_;
  std::size_t leaves_ = 0, unlisted_ = 0;
};

}  // namespace pointwise

}  // namespace clearance
