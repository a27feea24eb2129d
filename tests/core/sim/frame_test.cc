#include "core/sim/frame.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace fascicle {
namespace {

Frame NodeCloud() {
  Frame frame;
  frame.index = 3;
  frame.time = 0.25;
  frame.step = 7;
  frame.bodies = {{{Vec3(1, 2, 3), Vec3(4, 5, 6)}, {{"pressure", FieldLocation::kTetrahedron, 1, "Pa", {-1.5}}}}};
  frame.series = {10, 20};
  return frame;
}

Frame WithObjects() {
  Frame frame = NodeCloud();
  frame.poses = {{Vec3(1, 2, 3), {1, 0, 0, 0}}, {Vec3(4, 5, 6), {0, 1, 0, 0}}};
  frame.lines = {{{Vec3(1, 2, 3), Vec3(4, 5, 6)}, {0.5, 0.1}}, {{Vec3(7, 8, 9)}, {0.25}}};
  return frame;
}

// From Python's hashlib over struct.pack('<qdqQQ6dQQ8sQdQ2d', 3, 0.25, 7, 1, 2, 1, 2, 3, 4, 5, 6, 1, 8, b'pressure', 1,
// -1.5, 2, 10, 20): the digest of frames of bodies only.
TEST(FrameDigest, IsThatOfOlderFramesWithoutRigidBodiesAndLines) {
  EXPECT_EQ(Hex(DigestOf(NodeCloud())), "d707bf4b30ece898beacef3b65a0932a94845a8fdbe1bba4cda984a2202cfbae");
}

TEST(FrameDigest, ChangesWithEveryNumberOfPosesAndLines) {
  std::vector<std::function<void(Frame&)>> changes = {
      [](Frame& frame) { frame.poses.pop_back(); }, [](Frame& frame) { frame.poses.clear(); },
      [](Frame& frame) { std::swap(frame.poses[0], frame.poses[1]); }, [](Frame& frame) { frame.lines.pop_back(); },
      [](Frame& frame) { frame.lines.clear(); }, [](Frame& frame) { std::swap(frame.lines[0], frame.lines[1]); },
      [](Frame& frame) { frame.lines.emplace_back(); }, [](Frame& frame) { frame.lines[0].points.pop_back(); },
      [](Frame& frame) { frame.lines[0].values.pop_back(); },
      // The same numbers in the same order, divided differently among lines.
      [](Frame& frame) {
        frame.lines[1].values.insert(frame.lines[1].values.begin(), frame.lines[1].points[0].begin(),
                                     frame.lines[1].points[0].end());
        frame.lines[1].points.clear();
      }};
  for (std::size_t p = 0; p < 2; ++p) {
    for (int k = 0; k < 3; ++k) changes.push_back([=](Frame& frame) { frame.poses[p].position[k] += 1e-12; });
    for (std::size_t k = 0; k < 4; ++k) changes.push_back([=](Frame& frame) { frame.poses[p].quaternion[k] += 1e-12; });
    for (int k = 0; k < 3; ++k) changes.push_back([=](Frame& frame) { frame.lines[p].points.back()[k] += 1e-12; });
    changes.push_back([=](Frame& frame) { frame.lines[p].values.back() += 1e-12; });
  }
  std::set<Digest> digests = {DigestOf(NodeCloud()), DigestOf(WithObjects())};
  for (const auto& change : changes) {
    Frame frame = WithObjects();
    change(frame);
    digests.insert(DigestOf(frame));
  }
  EXPECT_EQ(digests.size(), changes.size() + 2);
}

}  // namespace
}  // namespace fascicle
