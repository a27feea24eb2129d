#include "core/linalg/elimination_order.h"

#include <algorithm>
#include <cstdio>
#include <mutex>

// scotch.h requires <cstdio>.
#include <scotch.h>

namespace fascicle {
namespace {

// Parts of up to 60 vertices are ordered by approximate minimum fill, including their boundary; larger ones are
// bisected on coarsened graphs, and each separator is refined on every level by the method of Fiduccia and Mattheyses.
constexpr const char* kStrategy =
    "n{sep=/(vert>60)?m{rat=0.7,vert=100,low=h{pass=10},asc=f{bal=0.2}};,"
    "ole=f{cmin=0,cmax=100000,frat=0.0},ose=g}";

static_assert(sizeof(SCOTCH_Num) == sizeof(std::int32_t), "SCOTCH with 32-bit indices");

// The parser of strategies has global state.
std::mutex& LibraryMutex() {
  static std::mutex mutex;
  return mutex;
}

// Each edge at both of its ends; neighbours in ascending order.
struct Graph {
  std::span<const std::int32_t> NeighboursOf(std::int32_t vertex) const {
    return std::span(neighbours).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
  }

  std::vector<std::int32_t> begin = {0}, neighbours;
};

Graph GraphOfPattern(std::int32_t size, std::span<const std::int32_t> rows, std::span<const std::int32_t> columns) {
  Graph graph;
  graph.begin.assign(static_cast<std::size_t>(size) + 1, 0);
  const auto for_edges = [&](const auto& visit) {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (rows[k] == columns[k]) continue;
      visit(rows[k], columns[k]);
      visit(columns[k], rows[k]);
    }
  };
  for_edges([&](std::int32_t from, std::int32_t) { ++graph.begin[from + 1]; });
  for (std::int32_t i = 0; i < size; ++i) graph.begin[i + 1] += graph.begin[i];
  graph.neighbours.resize(graph.begin[size]);
  std::vector<std::int32_t> next(graph.begin.begin(), graph.begin.end() - 1);
  for_edges([&](std::int32_t from, std::int32_t to) { graph.neighbours[next[from]++] = to; });
  for (std::int32_t i = 0; i < size; ++i) {
    std::sort(graph.neighbours.begin() + graph.begin[i], graph.neighbours.begin() + graph.begin[i + 1]);
  }
  return graph;
}

// Whether neighbours a and b have the same neighbours except for themselves.
bool AreAlike(const Graph& graph, std::int32_t a, std::int32_t b) {
  const auto of_a = graph.NeighboursOf(a), of_b = graph.NeighboursOf(b);
  if (of_a.size() != of_b.size()) return false;
  auto j = of_b.begin();
  for (const std::int32_t n : of_a) {
    if (n == b) continue;
    if (j != of_b.end() && *j == a) ++j;
    if (j == of_b.end() || *j != n) return false;
    ++j;
  }
  return true;
}

// The group of equivalent unknowns of each unknown; groups are numbered in the order of their first unknowns.
struct Groups {
  std::vector<std::int32_t> of, first, size;
};

Groups GroupsOf(const Graph& graph) {
  const auto unknowns = static_cast<std::int32_t>(graph.begin.size()) - 1;
  Groups groups;
  groups.of.assign(unknowns, -1);
  for (std::int32_t i = 0; i < unknowns; ++i) {
    if (groups.of[i] >= 0) continue;
    const auto group = static_cast<std::int32_t>(groups.first.size());
    groups.of[i] = group;
    groups.first.push_back(i);
    groups.size.push_back(1);
    for (const std::int32_t j : graph.NeighboursOf(i)) {
      if (groups.of[j] >= 0 || !AreAlike(graph, i, j)) continue;
      groups.of[j] = group;
      ++groups.size[group];
    }
  }
  return groups;
}

// The graph with the groups as vertices.
Graph GraphOfGroups(const Graph& graph, const Groups& groups) {
  Graph result;
  std::vector<std::int32_t> seen_from(groups.first.size(), -1);
  for (std::int32_t g = 0; g < static_cast<std::int32_t>(groups.first.size()); ++g) {
    seen_from[g] = g;
    for (const std::int32_t j : graph.NeighboursOf(groups.first[g])) {
      const std::int32_t h = groups.of[j];
      if (seen_from[h] == g) continue;
      seen_from[h] = g;
      result.neighbours.push_back(h);
    }
    result.begin.push_back(static_cast<std::int32_t>(result.neighbours.size()));
  }
  return result;
}

// Owners of SCOTCH's objects.
struct Context {
  Context() { SCOTCH_contextInit(&scotch); }
  ~Context() { SCOTCH_contextExit(&scotch); }
  // Its own thread and random numbers.
  bool Isolate() {
    if (SCOTCH_contextRandomClone(&scotch) != 0 || SCOTCH_contextThreadSpawn(&scotch, 1, nullptr) != 0) return false;
    SCOTCH_contextRandomSeed(&scotch, 1);
    SCOTCH_contextRandomReset(&scotch);
    return true;
  }
  SCOTCH_Context scotch;
};

struct ScotchGraph {
  ScotchGraph() { SCOTCH_graphInit(&scotch); }
  ~ScotchGraph() { SCOTCH_graphExit(&scotch); }
  SCOTCH_Graph scotch;
};

struct Strategy {
  Strategy() { SCOTCH_stratInit(&scotch); }
  ~Strategy() { SCOTCH_stratExit(&scotch); }
  SCOTCH_Strat scotch;
};

// The position of each vertex; false if memory runs out.
bool Dissect(const Graph& graph, const std::vector<std::int32_t>& weights, std::vector<std::int32_t>& place) {
  const std::lock_guard lock(LibraryMutex());
  Context context;
  ScotchGraph whole, bound;
  Strategy strategy;
  const auto vertices = static_cast<SCOTCH_Num>(weights.size());
  const auto edges = static_cast<SCOTCH_Num>(graph.neighbours.size());
  place.resize(weights.size());
  return context.Isolate() && SCOTCH_stratGraphOrder(&strategy.scotch, kStrategy) == 0 &&
         SCOTCH_graphBuild(&whole.scotch, 0, vertices, graph.begin.data(), nullptr, weights.data(), nullptr, edges,
                           graph.neighbours.data(), nullptr) == 0 &&
         SCOTCH_contextBindGraph(&context.scotch, &whole.scotch, &bound.scotch) == 0 &&
         SCOTCH_graphOrder(&bound.scotch, &strategy.scotch, place.data(), nullptr, nullptr, nullptr, nullptr) == 0;
}

}  // namespace

std::vector<std::int32_t> EliminationOrder(std::int32_t size, std::span<const std::int32_t> rows,
                                           std::span<const std::int32_t> columns) {
  Groups groups;
  std::vector<std::int32_t> place;
  {
    Graph graph = GraphOfPattern(size, rows, columns);
    groups = GroupsOf(graph);
    graph = GraphOfGroups(graph, groups);
    if (!Dissect(graph, groups.size, place)) return {};
  }
  // The first position of each group's unknowns.
  std::vector<std::int32_t> group_at(place.size()), start(place.size());
  for (std::size_t g = 0; g < place.size(); ++g) group_at[place[g]] = static_cast<std::int32_t>(g);
  std::int32_t next = 0;
  for (const std::int32_t g : group_at) {
    start[g] = next;
    next += groups.size[g];
  }
  std::vector<std::int32_t> order(size);
  for (std::int32_t i = 0; i < size; ++i) order[i] = start[groups.of[i]]++;
  return order;
}

}  // namespace fascicle
