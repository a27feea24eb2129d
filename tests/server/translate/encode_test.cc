#include <cstring>

#include <gtest/gtest.h>

#include "scenes.h"

namespace fascicle::server {
namespace {

// Reads one value out of the bytes of a message, bit by bit.
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
  ASSERT_EQ(encoded.positions().size(), body.tet().mesh.nodes.size() * 24);
  ASSERT_EQ(encoded.tetrahedra().size(), body.tet().mesh.tetrahedra.size() * 16);
  ASSERT_EQ(encoded.fibres().size(), body.tet().mesh.tetrahedra.size() * 24);
  for (std::size_t i = 0; i < body.tet().mesh.nodes.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(DoubleAt(encoded.positions(), 3 * i + static_cast<std::size_t>(k)), body.tet().mesh.nodes[i][k]);
  }
  for (std::size_t i = 0; i < body.tet().mesh.tetrahedra.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(IndexAt(encoded.tetrahedra(), 4 * i + k), static_cast<std::uint32_t>(body.tet().mesh.tetrahedra[i][k]));
    }
  }
  EXPECT_EQ(DoubleAt(encoded.fibres(), 2), body.tet().fibres[0].z());
  ASSERT_EQ(encoded.regions_size(), 2);
  EXPECT_EQ(encoded.regions(1).name(), "top");
  ASSERT_EQ(encoded.regions(1).nodes().size(), 12u * 4u);
  EXPECT_EQ(IndexAt(encoded.regions(1).nodes(), 11), static_cast<std::uint32_t>(body.regions[1].nodes[11]));
  ASSERT_EQ(geometry.series_size(), 1);
  EXPECT_EQ(geometry.series(0).name(), "energy/elastic");
  EXPECT_EQ(geometry.series(0).unit(), "J");
  EXPECT_EQ(geometry.series(0).description(), "Elastic energy");
}

// Hexahedra are encoded as bricks, corner c at (c & 1, c >> 1 & 1, c >> 2), with a fibre each.
TEST(Encode, HexahedraAreBricks) {
  v1::Scene wire = BoxScene();
  for (const double x : {0.0, 3.0, 4.0}) wire.mutable_bodies(0)->mutable_fibres()->mutable_constant()->add_direction(x);
  wire.mutable_tet()->set_element(v1::ELEMENT_HEXAHEDRAL);
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const TetMesh& mesh = scene->bodies[0].tet().mesh;
  const v1::BodyGeometry encoded = EncodeGeometry(*scene, {}).bodies(0);
  EXPECT_TRUE(encoded.tetrahedra().empty());
  ASSERT_GT(mesh.hexahedra.size(), 1u);
  ASSERT_EQ(encoded.bricks().size(), mesh.hexahedra.size() * 32);
  EXPECT_EQ(encoded.fibres().size(), mesh.hexahedra.size() * 24);
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    const Vec3& first = mesh.nodes[IndexAt(encoded.bricks(), 8 * h)];
    const Vec3 size = mesh.nodes[IndexAt(encoded.bricks(), 8 * h + 7)] - first;
    for (std::size_t c = 0; c < 8; ++c) {
      const Vec3 corner(c & 1, c >> 1 & 1, c >> 2);
      const Vec3 expected = first + size.cwiseProduct(corner);
      EXPECT_LT((mesh.nodes[IndexAt(encoded.bricks(), 8 * h + c)] - expected).norm(), 1e-12);
    }
  }
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

TEST(Encode, GeometryCarriesRigidBodiesAndLines) {
  FrameLayout layout;
  layout.rigid_bodies = {{"humerus",
                          {{Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(7, 8, 9.5)}, {{0, 1, 2}, {2, 1, 0}}},
                          {Vec3(-1, -2, -3), {0, 0, 0, 1}},
                          true,
                          false},
                         {"ground", {}, {}, false, true}};
  layout.lines = {{"biceps", {{"activation", "1", "how active it is"}, {"length", "m", "of the whole path"}}},
                  {"cord", {}}};
  const v1::Geometry geometry = EncodeGeometry(*Translate(BoxScene()), layout);
  ASSERT_EQ(geometry.rigid_bodies_size(), 2);
  const v1::RigidBodyGeometry& humerus = geometry.rigid_bodies(0);
  EXPECT_EQ(humerus.name(), "humerus");
  EXPECT_TRUE(humerus.moves());
  EXPECT_FALSE(humerus.unbounded());
  ASSERT_EQ(humerus.positions().size(), 9u * 8u);
  EXPECT_EQ(DoubleAt(humerus.positions(), 8), 9.5);
  ASSERT_EQ(humerus.triangles().size(), 6u * 4u);
  EXPECT_EQ(IndexAt(humerus.triangles(), 3), 2u);
  ASSERT_EQ(humerus.pose().size(), 7u * 8u);
  EXPECT_EQ(DoubleAt(humerus.pose(), 2), -3);
  EXPECT_EQ(DoubleAt(humerus.pose(), 3), 0) << "w comes first";
  EXPECT_EQ(DoubleAt(humerus.pose(), 6), 1);
  EXPECT_FALSE(geometry.rigid_bodies(1).moves());
  EXPECT_TRUE(geometry.rigid_bodies(1).unbounded());
  EXPECT_EQ(DoubleAt(geometry.rigid_bodies(1).pose(), 3), 1);
  ASSERT_EQ(geometry.lines_size(), 2);
  EXPECT_EQ(geometry.lines(0).name(), "biceps");
  ASSERT_EQ(geometry.lines(0).values_size(), 2);
  EXPECT_EQ(geometry.lines(0).values(1).name(), "length");
  EXPECT_EQ(geometry.lines(0).values(1).unit(), "m");
  EXPECT_EQ(geometry.lines(0).values(1).description(), "of the whole path");
  EXPECT_EQ(geometry.lines(1).values_size(), 0);
}

TEST(Encode, FrameKeepsPosesAndLines) {
  Frame frame;
  frame.poses = {{Vec3(1, -0.0, 1e-310), {0.5, -0.5, 0.5, -0.5}}, {}};
  frame.lines = {{{Vec3(1, 2, 3), Vec3(4, 5, 0.1 + 0.2)}, {0.25, 1e-310}}, {}};
  const v1::Frame encoded = EncodeFrame(frame);
  ASSERT_EQ(encoded.poses().size(), 2u * 7u * 8u);
  EXPECT_TRUE(std::signbit(DoubleAt(encoded.poses(), 1)));
  EXPECT_EQ(DoubleAt(encoded.poses(), 2), 1e-310);
  EXPECT_EQ(DoubleAt(encoded.poses(), 4), -0.5);
  EXPECT_EQ(DoubleAt(encoded.poses(), 10), 1);
  ASSERT_EQ(encoded.lines_size(), 2);
  ASSERT_EQ(encoded.lines(0).points().size(), 6u * 8u);
  EXPECT_EQ(DoubleAt(encoded.lines(0).points(), 5), 0.1 + 0.2);
  ASSERT_EQ(encoded.lines(0).values_size(), 2);
  EXPECT_EQ(encoded.lines(0).values(1), 1e-310);
  EXPECT_TRUE(encoded.lines(1).points().empty());
}

// The same bytes as before frames could contain other objects than bodies.
TEST(Encode, FrameWithoutPosesAndLinesHasNothingOfThem) {
  const v1::Frame encoded = EncodeFrame({});
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  encoded.GetReflection()->ListFields(encoded, &fields);
  ASSERT_EQ(fields.size(), 1u);
  EXPECT_EQ(fields[0]->name(), "digest");
}

TEST(Encode, FailureNamesItsObjectWithItsKind) {
  for (const auto& [kind, encoded_kind] : {std::pair{ObjectKind::kBody, v1::Failure::OBJECT_KIND_BODY},
                                           {ObjectKind::kRigidBody, v1::Failure::OBJECT_KIND_RIGID_BODY},
                                           {ObjectKind::kLine, v1::Failure::OBJECT_KIND_LINE},
                                           {ObjectKind::kJoint, v1::Failure::OBJECT_KIND_JOINT},
                                           {ObjectKind::kNone, v1::Failure::OBJECT_KIND_UNSPECIFIED}}) {
    Failure failure;
    failure.object_kind = kind;
    failure.object = "elbow";
    const v1::Failure encoded = EncodeFailure(failure);
    EXPECT_EQ(encoded.object_kind(), encoded_kind);
    EXPECT_EQ(encoded.object(), "elbow");
    EXPECT_EQ(encoded.body(), kind == ObjectKind::kBody ? "elbow" : "") << "for clients that know bodies alone";
  }
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
  EXPECT_EQ(encoded.object(), "muscle");
  ASSERT_EQ(encoded.element_ids_size(), 2);
  EXPECT_EQ(encoded.element_ids(1), 9);
  EXPECT_EQ(encoded.advice(), "take a smaller step");
}

}  // namespace
}  // namespace fascicle::server
