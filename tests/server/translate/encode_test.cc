#include <cstring>

#include <gtest/gtest.h>

#include "scenes.h"

namespace fascicle::server {
namespace {

// Reads one value out of the bytes of a message, the slow way.
double DoubleAt(const std::string& bytes, std::size_t index) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i)
    bits |= std::uint64_t(static_cast<unsigned char>(bytes.at(8 * index + i))) << (8 * i);
  double value = 0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

std::uint32_t IndexAt(const std::string& bytes, std::size_t index) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::uint32_t(static_cast<unsigned char>(bytes.at(4 * index + i))) << (8 * i);
  return value;
}

TEST(Encode, GeometryCarriesNodesTetrahedraFibresAndRegions) {
  v1::Scene wire = BoxScene();
  for (const double x : {0.0, 3.0, 4.0}) wire.mutable_bodies(0)->mutable_fibres()->mutable_constant()->add_direction(x);
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const Body& body = scene->bodies[0];
  const v1::Geometry geometry = EncodeGeometry(*scene, {{}, {}, {{"energy/elastic", "J", "Elastic energy"}}});
  ASSERT_EQ(geometry.bodies_size(), 1);
  const v1::BodyGeometry& encoded = geometry.bodies(0);
  EXPECT_EQ(encoded.name(), "box");
  ASSERT_EQ(encoded.positions().size(), body.mesh.nodes.size() * 24);
  ASSERT_EQ(encoded.tetrahedra().size(), body.mesh.tetrahedra.size() * 16);
  ASSERT_EQ(encoded.fibres().size(), body.mesh.tetrahedra.size() * 24);
  for (std::size_t i = 0; i < body.mesh.nodes.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(DoubleAt(encoded.positions(), 3 * i + static_cast<std::size_t>(k)), body.mesh.nodes[i][k]);
  }
  for (std::size_t i = 0; i < body.mesh.tetrahedra.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(IndexAt(encoded.tetrahedra(), 4 * i + k), static_cast<std::uint32_t>(body.mesh.tetrahedra[i][k]));
    }
  }
  EXPECT_EQ(DoubleAt(encoded.fibres(), 2), body.fibres[0].z());
  ASSERT_EQ(encoded.regions_size(), 2);
  EXPECT_EQ(encoded.regions(1).name(), "top");
  ASSERT_EQ(encoded.regions(1).nodes().size(), 12u * 4u);
  EXPECT_EQ(IndexAt(encoded.regions(1).nodes(), 11), static_cast<std::uint32_t>(body.regions[1].nodes[11]));
  ASSERT_EQ(geometry.series_size(), 1);
  EXPECT_EQ(geometry.series(0).name(), "energy/elastic");
  EXPECT_EQ(geometry.series(0).unit(), "J");
  EXPECT_EQ(geometry.series(0).description(), "Elastic energy");
}

TEST(Encode, FrameKeepsEveryBit) {
  Frame frame;
  frame.index = 3;
  frame.time = 0.1 + 0.2;
  frame.step = 12345678901;
  frame.bodies.resize(2);
  frame.bodies[0].positions = {Vec3(1, -0.0, 1e-310), Vec3(0.1, 0.2, 0.3)};
  frame.bodies[0].fields = {{"velocity", FieldLocation::kNode, 3, "m/s", {1, 2, 3, 4, 5, 6}},
                            {"pressure", FieldLocation::kTetrahedron, 1, "Pa", {-7.5}}};
  frame.series = {1.5, 2.5};
  frame.digest = Sha256Of("frame");
  const v1::Frame encoded = EncodeFrame(frame);
  EXPECT_EQ(encoded.index(), 3);
  EXPECT_EQ(encoded.time(), 0.1 + 0.2);
  EXPECT_EQ(encoded.step(), 12345678901);
  ASSERT_EQ(encoded.bodies_size(), 2);
  EXPECT_TRUE(std::signbit(DoubleAt(encoded.bodies(0).positions(), 1)));
  EXPECT_EQ(DoubleAt(encoded.bodies(0).positions(), 2), 1e-310);
  EXPECT_EQ(DoubleAt(encoded.bodies(0).positions(), 5), 0.3);
  ASSERT_EQ(encoded.bodies(0).fields_size(), 2);
  EXPECT_EQ(encoded.bodies(0).fields(0).location(), v1::FieldValues::LOCATION_NODE);
  EXPECT_EQ(encoded.bodies(0).fields(0).components(), 3);
  EXPECT_EQ(DoubleAt(encoded.bodies(0).fields(0).values(), 5), 6);
  EXPECT_EQ(encoded.bodies(0).fields(1).name(), "pressure");
  EXPECT_EQ(encoded.bodies(0).fields(1).unit(), "Pa");
  EXPECT_EQ(encoded.bodies(0).fields(1).location(), v1::FieldValues::LOCATION_TETRAHEDRON);
  EXPECT_TRUE(encoded.bodies(1).positions().empty());
  ASSERT_EQ(encoded.series_size(), 2);
  EXPECT_EQ(encoded.series(1), 2.5);
  EXPECT_EQ(encoded.digest(), std::string(frame.digest.begin(), frame.digest.end()));
}

TEST(Encode, FailureKeepsEverything) {
  const v1::Failure encoded = EncodeFailure({"INVERTED_ELEMENT",
                                             "an element turned over",
                                             17,
                                             0.25,
                                             ObjectKind::kBody,
                                             "muscle",
                                             {4, 9},
                                             "take a smaller step"});
  EXPECT_EQ(encoded.reason(), "INVERTED_ELEMENT");
  EXPECT_EQ(encoded.message(), "an element turned over");
  EXPECT_EQ(encoded.step(), 17);
  EXPECT_EQ(encoded.time(), 0.25);
  EXPECT_EQ(encoded.body(), "muscle");
  ASSERT_EQ(encoded.element_ids_size(), 2);
  EXPECT_EQ(encoded.element_ids(1), 9);
  EXPECT_EQ(encoded.advice(), "take a smaller step");
}

}  // namespace
}  // namespace fascicle::server
