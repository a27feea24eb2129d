// How elements are grouped into chunks and assigned to lanes.
#include "core/tet/chunk_order.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "core/geometry/shapes.h"
#include "core/tet/element_blocks.h"

namespace fascicle {
namespace {

struct CutBox {
  explicit CutBox(int divisions) : mesh(MakeBox(Vec3::Zero(), Vec3::Ones(), {divisions, divisions, divisions})) {
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) middles.push_back(Centroid(mesh, t));
    elements.resize(mesh.tetrahedra.size());
    std::iota(elements.begin(), elements.end(), 0);
    ends =
        CutIntoChunks(elements, middles, [this](std::span<const std::int32_t> part) { return NodesOf(part).size(); });
  }
  std::set<std::int32_t> NodesOf(std::span<const std::int32_t> part) const {
    std::set<std::int32_t> nodes;
    for (const std::int32_t e : part) nodes.insert(mesh.tetrahedra[e].begin(), mesh.tetrahedra[e].end());
    return nodes;
  }
  std::vector<std::span<const std::int32_t>> Chunks() const {
    std::vector<std::span<const std::int32_t>> chunks;
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      chunks.push_back(std::span(elements).subspan(begin, end - begin));
      begin = end;
    }
    return chunks;
  }

  TetMesh mesh;
  std::vector<Vec3> middles;
  std::vector<std::int32_t> elements;
  std::vector<std::size_t> ends;
};

TEST(ChunkOrderTest, EveryElementOnceInChunksOfNearlyEqualSize) {
  // Few elements form chunks of 1,024.
  for (const auto& [divisions, chunks] : {std::pair{1, 1u}, std::pair{5, 1u}, std::pair{13, 13u}}) {
    const CutBox box(divisions);
    std::vector<std::int32_t> sorted = box.elements;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t e = 0; e < sorted.size(); ++e) ASSERT_EQ(sorted[e], static_cast<std::int32_t>(e));
    ASSERT_EQ(box.ends.back(), box.elements.size());
    EXPECT_EQ(box.ends.size(), chunks);
    for (const auto& chunk : box.Chunks()) {
      EXPECT_LE(chunk.size(), 1024);
      EXPECT_GE(chunk.size(), box.elements.size() / chunks - 1);
    }
  }
}

TEST(ChunkOrderTest, ManyElementsAreCutIntoLargerChunks) {
  const CutBox box(24);
  EXPECT_LT(box.ends.size(), box.elements.size() / 2048);
  for (const auto& chunk : box.Chunks()) {
    EXPECT_LE(chunk.size(), kChunkElements);
    EXPECT_LE(box.NodesOf(chunk).size(), kChunkNodes);
  }
}

// A chunk of n elements is about a cube: no more nodes than a box of n/6 cells that is twice as long as wide.
TEST(ChunkOrderTest, ChunksAreCompact) {
  const CutBox box(16);
  for (const auto& chunk : box.Chunks()) {
    const double width = std::cbrt(static_cast<double>(chunk.size()) / 12);
    EXPECT_LT(static_cast<double>(box.NodesOf(chunk).size()), (width + 1) * (width + 1) * (2 * width + 1) * 1.1);
  }
}

// Successive elements rarely share a node, because a sum waits for the previous one.
TEST(ChunkOrderTest, NeighboursInABlockAreFarApart) {
  const CutBox box(16);
  std::size_t pairs = 0, sharing = 0;
  for (const auto& chunk : box.Chunks()) {
    for (std::size_t i = 0; i + 1 < chunk.size(); ++i) {
      if ((i + 1) % kBlock == 0) continue;
      ++pairs;
      sharing += box.NodesOf(chunk.subspan(i, 2)).size() < 8;
    }
  }
  EXPECT_LT(static_cast<double>(sharing), 0.2 * static_cast<double>(pairs));
}

// Chunks of elements without common nodes are limited by their number of nodes.
TEST(ChunkOrderTest, ChunksHaveNoMoreNodesThanTheyMay) {
  std::vector<std::int32_t> elements(kChunkElements);
  std::iota(elements.begin(), elements.end(), 0);
  std::vector<Vec3> middles;
  for (const std::int32_t e : elements) middles.emplace_back(e % 8, e / 8 % 8, e / 64);
  const auto ends =
      CutIntoChunks(elements, middles, [](std::span<const std::int32_t> part) { return 10 * part.size(); });
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    EXPECT_LE(10 * (end - begin), kChunkNodes);
    begin = end;
  }
  EXPECT_EQ(begin, elements.size());
}

TEST(ChunkOrderTest, NothingIsNoChunk) {
  std::vector<std::int32_t> none;
  EXPECT_TRUE(CutIntoChunks(none, {}, [](std::span<const std::int32_t>) { return std::size_t{0}; }).empty());
}

}  // namespace
}  // namespace fascicle
