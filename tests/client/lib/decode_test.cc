#include "client/lib/decode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <stdexcept>

#include "client/lib/series_table.h"
#include "client/lib/tetrahedra.h"
#include "core/base/frame_digest.h"
#include "tests/support/curved_ball.h"
#include "tests/support/sample_objects.h"

namespace fascicle::client {
namespace {

using ::fascicle::testing::Bytes;
using ::fascicle::testing::CurvedBall;
using ::fascicle::testing::QuarterTurn;
using ::fascicle::testing::SampleObjects;
using ::fascicle::testing::SampleObjectsFrame;

TEST(DecodeRigidBodies, GivesShapesAndPosesOfAllOfThem) {
  const std::vector<RigidShape> bodies = DecodeRigidBodies(SampleObjects());
  ASSERT_EQ(bodies.size(), 3u);
  EXPECT_EQ(bodies[0].name, "bone");
  EXPECT_TRUE(bodies[0].moves);
  EXPECT_EQ(bodies[0].positions.size(), 8u);
  EXPECT_EQ(bodies[0].triangles.size(), 12u);
  EXPECT_FALSE(bodies[1].moves);
  EXPECT_TRUE(bodies[2].triangles.empty());
  const std::vector<Pose> poses = PosesOf(SampleObjectsFrame(1), bodies);
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0].position, Vec3(0.04, 0.02, 0));
  EXPECT_EQ(poses[0].quaternion, QuarterTurn());
  EXPECT_EQ(poses[1].position, Vec3(0, 0, -0.1)) << "what stays has no pose in frames";
  // A quarter turn brings the corner (20, 10, 10) mm to (-10, 20, 10) mm.
  EXPECT_NEAR((PositionsAt(bodies[0], poses[0])[7] - Vec3(0.03, 0.04, 0.01)).norm(), 0, 1e-15);
}

TEST(DecodeGeometry, HasMidEdgeNodesAfterThoseOfTheMesh) {
  const CurvedBall ball;
  const BodyShape shape = DecodeGeometry(ball.geometry())[0];
  const std::size_t corners = ball.mesh().nodes.size();
  ASSERT_TRUE(shape.quadratic());
  ASSERT_EQ(shape.positions.size(), ball.nodes());
  ASSERT_EQ(shape.mid_edges.size(), shape.tetrahedra.size());
  double volume = 0;
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) volume += VolumeOf(shape, t, shape.positions);
  const double exact = 4. / 3 * M_PI * std::pow(CurvedBall::kRadius, 3);
  EXPECT_NEAR(volume, exact, 0.01 * exact) << "that of straight edges is 7 % too small";
  for (const std::uint32_t n : shape.regions[0].nodes) {
    EXPECT_NEAR(shape.positions[n].norm(), CurvedBall::kRadius, 1e-15);
  }
  EXPECT_GT(shape.regions[0].nodes.back(), corners);
  const v1::Frame frame = ball.frame(3);
  const std::vector<Vec3> x = DecodePositions(frame.bodies(0), shape.positions.size());
  const std::vector<double> v = DecodeField(frame.bodies(0).fields(0), shape);
  ASSERT_EQ(v.size(), 3 * shape.positions.size());
  for (std::size_t n = 0; n < x.size(); ++n) {
    EXPECT_DOUBLE_EQ(x[n].x(), 1.3 * shape.positions[n].x());
    EXPECT_DOUBLE_EQ(v[3 * n], shape.positions[n].x() * shape.positions[n].x());
  }
}

// Jobs of older servers have corners only; their frames keep the digest that they were stored with.
TEST(DecodeGeometry, ReadsJobsWithoutMidEdgeNodes) {
  const CurvedBall ball;
  const BodyShape shape = DecodeGeometry(CurvedBall::WithoutMidEdgeNodes(ball.geometry()))[0];
  EXPECT_FALSE(shape.quadratic());
  ASSERT_EQ(shape.positions.size(), ball.mesh().nodes.size());
  v1::Frame frame = CurvedBall::WithoutMidEdgeNodes(ball.frame(3));
  EXPECT_EQ(DecodePositions(frame.bodies(0), shape.positions.size()).size(), shape.positions.size());
  EXPECT_EQ(DecodeField(frame.bodies(0).fields(0), shape).size(), 3 * shape.positions.size());
  // Written out as it was before higher-order nodes existed.
  Sha256 sha;
  const auto add = [&sha](const auto& value) { sha.Update(std::as_bytes(std::span(&value, 1))); };
  const auto add_array = [&](const std::string& bytes, std::size_t size) {
    add(static_cast<std::uint64_t>(bytes.size() / size));
    sha.Update(std::as_bytes(std::span(bytes)));
  };
  add(std::int64_t{3});
  add(0.0);
  add(std::int64_t{0});
  add(std::uint64_t{1});
  add_array(frame.bodies(0).positions(), 24);
  add(std::uint64_t{1});
  add_array("velocity", 1);
  add_array(frame.bodies(0).fields(0).values(), 8);
  add(std::uint64_t{0});
  const Digest digest = sha.Finish();
  frame.set_digest(digest.data(), digest.size());
  EXPECT_NO_THROW(CheckDigest(frame));
}

// Elements of a later server: hexahedra of 20 nodes are drawn with their corners.
TEST(DecodeGeometry, LeavesOutHigherOrderNodesThatItDoesNotKnow) {
  const CurvedBall ball;
  v1::Geometry geometry = ball.geometry();
  *geometry.mutable_bodies(0)->mutable_higher_order_nodes() += geometry.bodies(0).higher_order_nodes();
  const BodyShape shape = DecodeGeometry(geometry)[0];
  EXPECT_FALSE(shape.quadratic());
  EXPECT_EQ(DecodePositions(ball.frame(1).bodies(0), shape.positions.size()).size(), ball.mesh().nodes.size());
}

TEST(DecodeGeometry, RefusesMidEdgeNodesThatDoNotFit) {
  const CurvedBall ball;
  for (const auto& damage :
       {std::function<void(v1::BodyGeometry&)>([](auto& body) { body.mutable_higher_order_positions()->pop_back(); }),
        std::function<void(v1::BodyGeometry&)>(
            [](auto& body) { body.mutable_higher_order_positions()->resize(24); })}) {
    v1::Geometry geometry = ball.geometry();
    damage(*geometry.mutable_bodies(0));
    EXPECT_THROW(DecodeGeometry(geometry), std::runtime_error);
  }
  const BodyShape shape = DecodeGeometry(ball.geometry())[0];
  v1::Frame frame = ball.frame(1);
  frame.mutable_bodies(0)->mutable_higher_order_positions()->resize(240);
  EXPECT_THROW(DecodePositions(frame.bodies(0), shape.positions.size()), std::runtime_error);
  frame.mutable_bodies(0)->mutable_fields(0)->clear_all_values();
  EXPECT_THROW(DecodeField(frame.bodies(0).fields(0), shape), std::runtime_error);
}

TEST(DecodeLines, GivesPathsThatChangeTheirNumberOfPoints) {
  const std::vector<LineInfo> lines = DecodeLineInfos(SampleObjects());
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].values[1].unit(), "m");
  const std::vector<LinePath> first = DecodeLines(SampleObjectsFrame(0), lines);
  EXPECT_EQ(first[0].points.size(), 3u);
  EXPECT_TRUE(first[1].points.empty());
  const std::vector<LinePath> later = DecodeLines(SampleObjectsFrame(2), lines);
  EXPECT_EQ(later[0].points.size(), 4u);
  EXPECT_EQ(later[0].points[1], Vec3(0, -0.1, 0));
  EXPECT_EQ(later[0].values, (std::vector<double>{0.2, 0.4}));
}

// Malformed messages must cause an error with a message for users and nothing else.
template <class Message>
void ExpectRefused(const std::function<void(Message&)>& damage, const std::function<void(const Message&)>& read,
                   Message message) {
  EXPECT_NO_THROW(read(message));
  damage(message);
  EXPECT_THROW(read(message), std::runtime_error) << message.ShortDebugString();
}

TEST(DecodeRigidBodies, RefusesBytesThatDoNotFit) {
  using Damage = std::function<void(v1::Geometry&)>;
  const auto pose = [](Pose value) { return Bytes(std::vector<Pose>{value}); };
  for (const Damage& damage : {
           Damage([](auto& g) { g.mutable_rigid_bodies(0)->mutable_positions()->pop_back(); }),
           Damage([](auto& g) { g.mutable_rigid_bodies(0)->mutable_triangles()->pop_back(); }),
           Damage([](auto& g) { g.mutable_rigid_bodies(0)->mutable_triangles()->back() = '\x7f'; }),
           Damage([](auto& g) { g.mutable_rigid_bodies(0)->clear_pose(); }),
           Damage([](auto& g) { g.mutable_rigid_bodies(0)->mutable_pose()->pop_back(); }),
           Damage([](auto& g) { g.mutable_rigid_bodies(0)->mutable_pose()->append(56, '\0'); }),
           Damage([&](auto& g) {
             g.mutable_rigid_bodies(0)->set_pose(pose({Vec3::Zero(), {0, 0, 0, 0}}));
           }),
           Damage([&](auto& g) {
             g.mutable_rigid_bodies(0)->set_pose(pose({Vec3::Zero(), {1, 0, 0.1, 0}}));
           }),
           Damage([&](auto& g) {
             g.mutable_rigid_bodies(0)->set_pose(pose({Vec3(0, NAN, 0), {1, 0, 0, 0}}));
           }),
       }) {
    ExpectRefused<v1::Geometry>(
        damage, [](const v1::Geometry& geometry) { DecodeRigidBodies(geometry); }, SampleObjects());
  }
}

TEST(DecodeFrames, RefusesPosesAndLinesThatDoNotFit) {
  using Damage = std::function<void(v1::Frame&)>;
  const std::vector<RigidShape> bodies = DecodeRigidBodies(SampleObjects());
  const std::vector<LineInfo> lines = DecodeLineInfos(SampleObjects());
  for (const Damage& damage : {
           Damage([](auto& f) { f.mutable_poses()->pop_back(); }),
           Damage([](auto& f) { f.clear_poses(); }),
           Damage([](auto& f) { f.mutable_poses()->append(56, '\0'); }),
           Damage([](auto& f) {
             f.set_poses(Bytes(std::vector<Pose>{{Vec3::Zero(), {1, 1, 0, 0}}, {}}));
           }),
           Damage([](auto& f) {
             f.set_poses(Bytes(std::vector<Pose>{{}, {Vec3(0, 0, INFINITY), {1, 0, 0, 0}}}));
           }),
           Damage([](auto& f) { f.mutable_lines(0)->add_values(1); }),
           Damage([](auto& f) { f.mutable_lines(0)->mutable_values()->RemoveLast(); }),
           Damage([](auto& f) { f.mutable_lines(0)->mutable_points()->pop_back(); }),
           Damage([](auto& f) {
             f.mutable_lines(0)->set_points(Bytes(std::vector<double>{0, NAN, 0}));
           }),
           Damage([](auto& f) { f.mutable_lines()->RemoveLast(); }),
           Damage([](auto& f) { *f.add_lines() = f.lines(0); }),
       }) {
    ExpectRefused<v1::Frame>(
        damage,
        [&](const v1::Frame& frame) {
          PosesOf(frame, bodies);
          DecodeLines(frame, lines);
        },
        SampleObjectsFrame(1));
    // A table refuses the same frames.
    ExpectRefused<v1::Frame>(
        damage, [](const v1::Frame& frame) { SeriesTable(SampleObjects()).Add(frame); }, SampleObjectsFrame(1));
  }
}

TEST(CheckFits, CountsEveryKindOfObject) {
  const v1::Geometry geometry = SampleObjects();
  EXPECT_NO_THROW(CheckFits(SampleObjectsFrame(1), geometry));
  v1::Frame frame = SampleObjectsFrame(1);
  frame.add_lines();
  EXPECT_THROW(CheckFits(frame, geometry), std::runtime_error);
  frame = SampleObjectsFrame(1);
  frame.mutable_poses()->resize(56);
  EXPECT_THROW(CheckFits(frame, geometry), std::runtime_error);
  frame = SampleObjectsFrame(1);
  frame.add_bodies();
  EXPECT_THROW(CheckFits(frame, geometry), std::runtime_error);
}

// Bytes changed, added or removed at random, with a fixed seed.
TEST(DecodeFrames, GiveDamagedMessagesWholeOrNotAtAll) {
  std::mt19937 random(1);
  const auto damage = [&random](std::string bytes) {
    for (int n = std::uniform_int_distribution(1, 4)(random); n > 0 && !bytes.empty(); --n) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 3) {
        case 0:
          bytes[at] = static_cast<char>(random());
          break;
        case 1:
          bytes.erase(at, 1 + random() % 16);
          break;
        case 2:
          bytes.insert(at, 1 + random() % 16, static_cast<char>(random()));
          break;
      }
    }
    return bytes;
  };
  int read = 0, refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    v1::Geometry geometry = SampleObjects();
    v1::Frame frame = SampleObjectsFrame(1);
    v1::RigidBodyGeometry& body = *geometry.mutable_rigid_bodies(static_cast<int>(random() % 3));
    v1::LineFrame& line = *frame.mutable_lines(static_cast<int>(random() % 2));
    switch (i % 6) {
      case 0:
        body.set_positions(damage(body.positions()));
        break;
      case 1:
        body.set_triangles(damage(body.triangles()));
        break;
      case 2:
        body.set_pose(damage(body.pose()));
        break;
      case 3:
        frame.set_poses(damage(frame.poses()));
        break;
      case 4:
        line.set_points(damage(line.points()));
        break;
      case 5:  // the whole message; most can't be parsed
        if (!frame.ParseFromString(damage(frame.SerializeAsString()))) continue;
        break;
    }
    try {
      const std::vector<RigidShape> bodies = DecodeRigidBodies(geometry);
      const std::vector<Pose> poses = PosesOf(frame, bodies);
      const std::vector<LineInfo> infos = DecodeLineInfos(geometry);
      const std::vector<LinePath> lines = DecodeLines(frame, infos);
      ASSERT_EQ(poses.size(), bodies.size());
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        ASSERT_NEAR(RotationOf(poses[b]).determinant(), 1, 1e-5);
        for (const auto& t : bodies[b].triangles)
          ASSERT_LT(*std::max_element(t.begin(), t.end()), bodies[b].positions.size());
      }
      ASSERT_EQ(lines.size(), infos.size());
      for (std::size_t l = 0; l < lines.size(); ++l) ASSERT_EQ(lines[l].values.size(), infos[l].values.size());
      ++read;
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 1000);
}

TEST(SeriesTable, HasTheValuesOfLinesAndThePosesOfWhatMoves) {
  v1::Geometry geometry = SampleObjects();
  geometry.add_series()->set_name("energy/kinetic");
  SeriesTable table(geometry);
  for (const int index : {0, 2}) {
    v1::Frame frame = SampleObjectsFrame(index);
    frame.add_series(7 + index);
    table.Add(frame);
  }
  std::vector<std::string> names;
  for (const SeriesTable::Column& column : table.columns()) {
    names.push_back(column.name);
    ASSERT_EQ(column.values.size(), 2u);
    EXPECT_EQ(column.is_pose, column.name.find("/pose/") != std::string::npos);
  }
  EXPECT_THAT(names,
              ::testing::ElementsAre("energy/kinetic", "flexor/activation", "flexor/length", "slack/activation",
                                     "bone/pose/x", "bone/pose/y", "bone/pose/z", "bone/pose/qw", "bone/pose/qx",
                                     "bone/pose/qy", "bone/pose/qz", "joint/pose/x", "joint/pose/y", "joint/pose/z",
                                     "joint/pose/qw", "joint/pose/qx", "joint/pose/qy", "joint/pose/qz"));
  EXPECT_EQ(table.columns()[0].values[1], 9);
  EXPECT_EQ(table.columns()[1].values[1], 0.2);
  EXPECT_EQ(table.columns()[2].unit, "m");
  EXPECT_EQ(table.columns()[3].values[0], 0.5);
  EXPECT_EQ(table.columns()[4].values[1], 0.04);
  EXPECT_EQ(table.columns()[7].values[1], std::sqrt(0.5));
  EXPECT_EQ(table.columns()[14].values[1], 1);
}

}  // namespace
}  // namespace fascicle::client
