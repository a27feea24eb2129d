#include <gif_lib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>

#include "client/render/body_mesh.h"
#include "client/render/colour_scale.h"
#include "client/render/colouring.h"
#include "client/render/field_values.h"
#include "client/render/picture.h"
#include "client/render/plot.h"
#include "client/render/rest_outline.h"
#include "client/render/slices.h"
#include "client/render/ticks.h"
#include "client/render/view.h"
#include "client/vtk/body_grid.h"
#include "tests/support/curved_ball.h"
#include "tests/support/files.h"
#include "tests/support/sample_job.h"
#include "tests/support/sample_objects.h"

namespace fascicle::client {
namespace {

using ::fascicle::testing::AddLine;
using ::fascicle::testing::AddRigidBody;
using ::fascicle::testing::Bytes;
using ::fascicle::testing::CurvedBall;
using ::fascicle::testing::SampleJob;
using ::fascicle::testing::SampleObjects;
using ::fascicle::testing::SampleObjectsFrame;
using ::fascicle::testing::TemporaryFolder;
using ::testing::HasSubstr;

using Pixel = std::array<int, 3>;

struct Image {
  int width = 0, height = 0;
  std::vector<Pixel> pixels;  // from the bottom

  std::size_t Count(const std::function<bool(const Pixel&)>& wanted) const {
    return static_cast<std::size_t>(std::count_if(pixels.begin(), pixels.end(), wanted));
  }
  std::size_t Colours() const { return std::set<Pixel>(pixels.begin(), pixels.end()).size(); }
};

Image ReadPng(const std::string& path) {
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData& data = *reader->GetOutput();
  Image image{data.GetDimensions()[0], data.GetDimensions()[1], {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto* p = static_cast<const unsigned char*>(data.GetScalarPointer(x, y, 0));
      image.pixels.push_back({p[0], p[1], p[2]});
    }
  }
  return image;
}

bool IsYellow(const Pixel& p) { return p[0] > 150 && p[1] > 140 && p[2] < 90; }
bool IsViolet(const Pixel& p) { return p[2] > p[1] + 20 && p[0] > p[1] + 5 && p[1] < 80; }
bool IsRed(const Pixel& p) { return p[0] > 120 && p[1] < 90 && p[2] < 90; }

class RenderTest : public ::testing::Test {
 protected:
  Image Draw(const PictureOptions& options, int frame = 10) {
    const std::string path = folder_ / "picture.png";
    DrawPicture(job_.geometry(), job_.frame(frame), options, path);
    return ReadPng(path);
  }
  PictureOptions Small() {
    PictureOptions options;
    options.size = {400, 300};
    return options;
  }

  SampleJob job_;
  TemporaryFolder folder_;
};

TEST_F(RenderTest, ShowsTheBellyInTheColoursOfItsField) {
  const Image image = Draw(Small());
  EXPECT_EQ(image.width, 400);
  EXPECT_EQ(image.height, 300);
  EXPECT_GT(image.Colours(), 500u);
  // The belly moves most, the ends least; both cover a good part of the picture.
  EXPECT_GT(image.Count(IsYellow), 1000u);
  EXPECT_GT(image.Count(IsViolet), 1000u);
}

TEST_F(RenderTest, WireframeSurfaceAndFibresAreSeparate) {
  PictureOptions options = Small();
  options.colour = "";
  options.rest_outline = false;
  options.surface = false;
  const auto is_dark = [](const Pixel& p) { return p[0] < 170 && p[1] < 170 && p[2] < 170; };
  const std::size_t empty = Draw(options).Count(is_dark);
  options.wireframe = true;
  EXPECT_GT(Draw(options).Count(is_dark), empty + 500);
  options.wireframe = false;
  options.fibres = true;
  const Image fibres = Draw(options);
  EXPECT_GT(fibres.Count(IsRed), 100u);
}

TEST_F(RenderTest, IsTheSamePictureEveryTime) { EXPECT_EQ(Draw(Small()).pixels, Draw(Small()).pixels); }

TEST_F(RenderTest, TheRestShapeCanBeDrawnToo) { EXPECT_GT(Draw(Small(), 0).Colours(), 100u); }

TEST_F(RenderTest, TheViewFollowsTheAngles) {
  PictureOptions options = Small();
  options.azimuth = -90;
  options.elevation = 0;
  const Image side = Draw(options);
  options.elevation = 90;
  EXPECT_NE(Draw(options).pixels, side.pixels);
}

TEST_F(RenderTest, NamesTheFieldsThatThereAre) {
  PictureOptions options = Small();
  options.colour = "temperature";
  try {
    Draw(options);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("displacement, velocity, von_mises_stress"));
  }
  options.colour = "velocity/q";
  EXPECT_THROW(Draw(options), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "picture.png"));
}

// A row of bricks along x, the last of them twice as long as the others in frame 1.
struct Bricks {
  v1::Geometry geometry;
  std::vector<v1::Frame> frames;

  explicit Bricks(int count) {
    std::vector<double> positions;
    std::vector<std::uint32_t> bricks;
    const auto node = [count](int i, int j, int k) {
      return static_cast<std::uint32_t>(i + (count + 1) * (j + 2 * k));
    };
    for (int k = 0; k < 2; ++k) {
      for (int j = 0; j < 2; ++j) {
        for (int i = 0; i <= count; ++i) positions.insert(positions.end(), {0.01 * i, 0.01 * j, 0.01 * k});
      }
    }
    for (int i = 0; i < count; ++i) {
      for (int c = 0; c < 8; ++c) bricks.push_back(node(i + (c & 1), c >> 1 & 1, c >> 2));
    }
    v1::BodyGeometry& body = *geometry.add_bodies();
    body.set_name("row");
    body.set_positions(Bytes(positions));
    body.set_bricks(Bytes(bricks));
    for (int f = 0; f < 2; ++f) {
      v1::Frame& frame = frames.emplace_back();
      frame.set_index(f);
      std::vector<double> moved = positions, values;
      for (int n = 0; n < 4; ++n) moved[3 * node(count, n & 1, n >> 1)] += 0.01 * f;
      for (int i = 0; i < count; ++i) values.push_back(f * i);
      v1::BodyFrame& of_body = *frame.add_bodies();
      of_body.set_positions(Bytes(moved));
      v1::FieldValues& field = *of_body.add_fields();
      field.set_name("volume_ratio");
      field.set_location(v1::FieldValues::LOCATION_BRICK);
      field.set_components(1);
      field.set_values(Bytes(values));
    }
  }
};

TEST_F(RenderTest, BricksAreDrawnInTheColoursOfTheirField) {
  const Bricks row(6);
  PictureOptions options = Small();
  options.colour = "volume_ratio";
  options.range = {0, 5};
  const std::string path = folder_ / "bricks.png";
  DrawPicture(row.geometry, row.frames[1], options, path);
  const Image image = ReadPng(path);
  EXPECT_GT(image.Count(IsYellow), 300u);
  EXPECT_GT(image.Count(IsViolet), 300u);
  options.smooth = true;
  DrawPicture(row.geometry, row.frames[1], options, path);
  EXPECT_NE(ReadPng(path).pixels, image.pixels);
}

// Fibres along x and z of a stretched row of hexahedra are drawn as lines through them.
TEST_F(RenderTest, FibresOfHexahedraAreDrawn) {
  Bricks row(6);
  std::vector<double> along, across;
  for (int e = 0; e < 6; ++e) {
    along.insert(along.end(), {1, 0, 0});
    across.insert(across.end(), {0, 0, 1});
  }
  PictureOptions options = Small();
  options.fibres = true;
  const std::string path = folder_ / "fibres.png";
  std::vector<Image> images;
  for (const std::vector<double>& fibres : {along, across}) {
    row.geometry.mutable_bodies(0)->set_fibres(Bytes(fibres));
    DrawPicture(row.geometry, row.frames[1], options, path);
    images.push_back(ReadPng(path));
  }
  options.fibres = false;
  DrawPicture(row.geometry, row.frames[1], options, path);
  images.push_back(ReadPng(path));
  EXPECT_NE(images[0].pixels, images[1].pixels);
  EXPECT_NE(images[0].pixels, images[2].pixels);
  EXPECT_NE(images[1].pixels, images[2].pixels);
}

// A cube of triangles whose upper side, coloured by its nodes, rises in frame 1.
struct Triangles {
  v1::Geometry geometry;
  v1::Frame frame;

  Triangles() {
    std::vector<double> positions, moved, values;
    for (int n = 0; n < 8; ++n) {
      positions.insert(positions.end(), {0.01 * (n & 1), 0.01 * (n >> 1 & 1), 0.01 * (n >> 2)});
      moved.insert(moved.end(), {positions[3 * n], positions[3 * n + 1], positions[3 * n + 2] * 1.5});
      values.push_back(n >> 2);
    }
    const std::vector<std::uint32_t> triangles = {0, 3, 1, 0, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                  2, 7, 3, 2, 6, 7, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    v1::BodyGeometry& body = *geometry.add_bodies();
    body.set_name("cube");
    body.set_positions(Bytes(positions));
    body.set_triangles(Bytes(triangles));
    v1::BodyFrame& of_body = *frame.add_bodies();
    of_body.set_positions(Bytes(moved));
    v1::FieldValues& field = *of_body.add_fields();
    field.set_name("volume_ratio");
    field.set_location(v1::FieldValues::LOCATION_NODE);
    field.set_components(1);
    field.set_values(Bytes(values));
  }
};

TEST_F(RenderTest, SurfacesAreDrawnInTheColoursOfTheirNodes) {
  const Triangles cube;
  PictureOptions options = Small();
  options.colour = "volume_ratio";
  const std::string path = folder_ / "triangles.png";
  DrawPicture(cube.geometry, cube.frame, options, path);
  const Image image = ReadPng(path);
  EXPECT_GT(image.Count(IsYellow), 300u);
  EXPECT_GT(image.Count(IsViolet), 300u);
  options.surface = false;
  options.wireframe = true;
  DrawPicture(cube.geometry, cube.frame, options, path);
  const Image edges = ReadPng(path);
  EXPECT_GT(edges.Count(IsYellow), 20u);
  EXPECT_LT(edges.Count(IsYellow), image.Count(IsYellow) / 2);
}

double AreaOf(vtkPolyData& surface) {
  double area = 0;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < surface.GetNumberOfCells(); ++cell) {
    surface.GetCellPoints(cell, ids);
    if (ids->GetNumberOfIds() != 3) continue;
    const Vec3 a(surface.GetPoint(ids->GetId(0))), b(surface.GetPoint(ids->GetId(1))),
        c(surface.GetPoint(ids->GetId(2)));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

// A ball of few quadratic elements is round, and so are its edges.
TEST(BodyMesh, SidesOfQuadraticElementsAreCurved) {
  const CurvedBall ball(4);
  constexpr double kRadius = CurvedBall::kRadius, kArea = 4 * M_PI * kRadius * kRadius;
  const BodyShape shape = DecodeGeometry(ball.geometry())[0];
  const BodyShape corners = DecodeGeometry(CurvedBall::WithoutMidEdgeNodes(ball.geometry()))[0];
  std::vector<double> values;
  for (const Vec3& X : shape.positions) values.push_back(X.x());
  const auto grid = MakeGrid(shape, shape.positions, values);
  EXPECT_NEAR(AreaOf(*MakeSurface(*grid)) / kArea, 1, 0.01);
  EXPECT_LT(AreaOf(*MakeSurface(*MakeGrid(corners, corners.positions, {}))) / kArea, 0.97) << "straight sides lose 3 %";
  const auto edges = MakeCurvedEdges(shape, shape.positions, values);
  ASSERT_GT(edges->GetNumberOfLines(), 50);
  vtkDataArray& colour = *edges->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < edges->GetNumberOfPoints(); ++i) {
    const Vec3 x(edges->GetPoint(i));
    EXPECT_NEAR(x.norm() / kRadius, 1, 0.02);
    EXPECT_NEAR(colour.GetTuple1(i), x.x(), 1e-15) << "a field that is x is x along the curve";
  }
}

// Volume rendering, slices and fibres use eight straight tetrahedra for each: their volume is nearly that of the ball.
TEST(BodyMesh, QuadraticElementsAreDividedForSampling) {
  const CurvedBall ball(6);
  const BodyShape shape = DecodeGeometry(ball.geometry())[0];
  const auto grid = MakeLinearGrid(shape, shape.positions);
  ASSERT_EQ(grid->GetNumberOfCells(), static_cast<vtkIdType>(8 * shape.tetrahedra.size()));
  double volume = 0;
  for (vtkIdType e = 0; e < grid->GetNumberOfCells(); ++e) {
    vtkIdType count;
    const vtkIdType* nodes;
    grid->GetCellPoints(e, count, nodes);
    ASSERT_EQ(count, 4);
    const Vec3 a(grid->GetPoint(nodes[0])), b(grid->GetPoint(nodes[1])), c(grid->GetPoint(nodes[2])),
        d(grid->GetPoint(nodes[3]));
    const double of_part = (b - a).cross(c - a).dot(d - a) / 6;
    EXPECT_GT(of_part, 0);
    volume += of_part;
  }
  const double exact = 4 * M_PI / 3 * std::pow(CurvedBall::kRadius, 3);
  EXPECT_NEAR(volume / exact, 1, 0.015);
  EXPECT_GT(MakeFibreLines(shape, shape.positions, 20)->GetNumberOfLines(), 10);
}

TEST(ValuesAtNodes, ForcesOnMidEdgeNodesAreCountedAtCorners) {
  const CurvedBall ball(2);
  const BodyShape shape = DecodeGeometry(ball.geometry())[0];
  v1::BodyFrame frame = ball.frame(0).bodies(0);
  v1::FieldValues& force = *frame.mutable_fields(0);
  force.set_name("internal_force");
  force.set_unit("N");
  const std::size_t corners = ball.mesh().nodes.size();
  force.set_values(Bytes(std::vector<double>(3 * corners, 1)));
  force.set_all_values(Bytes(std::vector<double>(3 * shape.positions.size(), 9)));
  EXPECT_EQ(ValuesAtNodes(shape, frame, "internal_force/x").values, std::vector<double>(shape.positions.size(), 1));
}

TEST_F(RenderTest, PanelsShareEyeAndScale) {
  PictureOptions options = Small();
  options.size = {800, 300};
  const std::vector<v1::Frame> frames = {job_.frame(0), job_.frame(10)};
  const std::string path = folder_ / "panels.png";
  DrawPanels(job_.geometry(), frames, options, path);
  const Image image = ReadPng(path);
  // Nothing has moved on the left, so all of it has the colour of zero.
  std::size_t left = 0, right = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < 565; ++x) {  // the scale is beside
      if (IsYellow(image.pixels[static_cast<std::size_t>(y * image.width + x)])) ++(x < 285 ? left : right);
    }
  }
  EXPECT_EQ(left, 0u);
  EXPECT_GT(right, 200u);
  EXPECT_THROW(DrawPanels(job_.geometry(), std::vector<v1::Frame>(25, job_.frame(0)), options, path),
               std::runtime_error);
}

// A cloud shows its inside: the middle of a thick body is denser than its rim.
TEST_F(RenderTest, ACloudIsDenserWhereItIsThicker) {
  PictureOptions options = Small();
  options.colour = "";
  options.rest_outline = false;
  options.volume = true;
  options.azimuth = 0;
  options.elevation = 0;
  const Image cloud = Draw(options, 0);
  // The belly, 32 mm thick, absorbs more light than the ends of 12 mm.
  const auto red = [](int least) { return [least](const Pixel& p) { return p[0] > p[2] + least; }; };
  EXPECT_GT(cloud.Count(red(10)), 2 * cloud.Count(red(90)));
  EXPECT_GT(cloud.Count(red(90)), 300u);
}

TEST_F(RenderTest, AnimationsAreGifsThatRepeat) {
  PictureOptions options = Small();
  options.size = {120, 90};
  const std::vector<v1::Frame> frames = {job_.frame(0), job_.frame(5), job_.frame(10)};
  const std::string path = folder_ / "run.gif";
  double done = 0;
  DrawAnimation(job_.geometry(), frames, options, {.frames_per_second = 20, .turntable = 0}, path,
                [&](double part) { done = part; });
  EXPECT_EQ(done, 1);
  int error = 0;
  GifFileType* gif = DGifOpenFileName(path.c_str(), &error);
  ASSERT_NE(gif, nullptr);
  ASSERT_EQ(DGifSlurp(gif), GIF_OK);
  EXPECT_EQ(gif->ImageCount, 3);
  EXPECT_EQ(gif->SWidth, 120);
  EXPECT_EQ(gif->SHeight, 90);
  GraphicsControlBlock control;
  ASSERT_EQ(DGifSavedExtensionToGCB(gif, 1, &control), GIF_OK);
  EXPECT_EQ(control.DelayTime, 5);  // 0.01 s
  const auto pixels = [&](int i) {
    return std::vector<GifByteType>(gif->SavedImages[i].RasterBits, gif->SavedImages[i].RasterBits + 120 * 90);
  };
  EXPECT_NE(pixels(0), pixels(2));
  DGifCloseFile(gif, &error);

  DrawAnimation(job_.geometry(), frames, options, {.frames_per_second = 20, .turntable = 4}, path);
  gif = DGifOpenFileName(path.c_str(), &error);
  ASSERT_NE(gif, nullptr);
  ASSERT_EQ(DGifSlurp(gif), GIF_OK);
  EXPECT_EQ(gif->ImageCount, 4);
  DGifCloseFile(gif, &error);
}

// Bone is warm, the background cold; the edges of lines are redder.
bool IsBone(const Pixel& p) { return p[0] > p[2] + 12 && p[0] - p[2] > 2 * (p[0] - p[1]); }

// The extent of the pixels that meet a condition, in columns [begin, end), without the axes in the lower left corner.
struct Extent {
  int left = 1 << 20, right = -1, bottom = 1 << 20, top = -1;
  std::size_t count = 0;

  Extent(const Image& image, const std::function<bool(const Pixel&)>& wanted, int begin = 0, int end = 1 << 20) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = begin; x < std::min(image.width, end); ++x) {
        if (5 * x < image.height && 5 * y < image.height) continue;
        if (!wanted(image.pixels[static_cast<std::size_t>(y * image.width + x)])) continue;
        left = std::min(left, x);
        right = std::max(right, x);
        bottom = std::min(bottom, y);
        top = std::max(top, y);
        ++count;
      }
    }
  }
  double width() const { return right - left + 1; }
  double height() const { return top - bottom + 1; }
  double x() const { return (left + right) / 2.0; }
  double y() const { return (bottom + top) / 2.0; }
};

class ObjectsTest : public RenderTest {
 protected:
  // From above, x to the right and y up.
  PictureOptions FromAbove() {
    PictureOptions options = Small();
    options.colour = "";
    options.azimuth = -90;
    options.elevation = 90;
    return options;
  }
  Image DrawObjects(const PictureOptions& options, int frame) {
    const std::string path = folder_ / "objects.png";
    DrawPicture(SampleObjects(), SampleObjectsFrame(frame), options, path);
    return ReadPng(path);
  }
};

// A box of 40 x 20 mm in a square of 200 mm, then rotated by 90 degrees and displaced by (40, 20) mm; the ground is
// below it.
TEST_F(ObjectsTest, RigidBodiesAreDrawnWhereTheyAre) {
  const Extent at_rest(DrawObjects(FromAbove(), 0), IsBone), moved(DrawObjects(FromAbove(), 1), IsBone);
  const double pixel = at_rest.width() / 0.04;  // a metre
  EXPECT_GT(at_rest.count, 300u);
  EXPECT_NEAR(at_rest.height(), 0.02 * pixel, 2);
  EXPECT_NEAR(static_cast<double>(at_rest.count), at_rest.width() * at_rest.height(), 60) << "it is filled";
  // The ground is visible where the bone was: a square of 20 mm around the origin.
  EXPECT_NEAR(moved.left, at_rest.x() - 0.01 * pixel, 2);
  EXPECT_NEAR(moved.right, at_rest.x() + 0.05 * pixel, 2);
  EXPECT_NEAR(moved.bottom, at_rest.y() - 0.01 * pixel, 2);
  EXPECT_NEAR(moved.top, at_rest.y() + 0.04 * pixel, 2);
  EXPECT_NEAR(static_cast<double>(moved.count), (0.04 * 0.02 + 0.02 * 0.02) * pixel * pixel, 80);
  PictureOptions options = FromAbove();
  options.rigid_bodies = false;
  EXPECT_EQ(Extent(DrawObjects(options, 1), IsBone).count, 0u);
}

TEST_F(ObjectsTest, LinesAreDrawnAsTubes) {
  const Image image = DrawObjects(FromAbove(), 0);
  const Extent bone(image, IsBone), line(image, IsRed);
  const double pixel = bone.width() / 0.04;
  // Along two sides of a square of 200 mm, with a radius of 0.5 % of the diagonal of everything, 0.3 m.
  EXPECT_NEAR(line.left, bone.x() - 0.1 * pixel, 4);
  EXPECT_NEAR(line.right, bone.x() + 0.1 * pixel, 4);
  EXPECT_NEAR(line.bottom, bone.y() - 0.1 * pixel, 4);
  EXPECT_NEAR(line.top, bone.y() + 0.1 * pixel, 4);
  const double area = 0.4 * 2 * 0.005 * 0.3 * pixel * pixel;
  EXPECT_GT(line.count, 0.5 * area);
  EXPECT_LT(line.count, 1.5 * area);
  PictureOptions options = FromAbove();
  options.lines = false;
  EXPECT_EQ(Extent(DrawObjects(options, 0), IsRed).count, 0u);
}

TEST_F(ObjectsTest, LinesHaveTheColoursOfTheirValues) {
  PictureOptions options = FromAbove();
  options.size = {800, 400};
  constexpr int kScale = 600;  // begins there
  options.colour = "activation";
  const Image image = DrawObjects(options, 1);
  const Extent flexor(image, IsViolet, 0, kScale), slack(image, IsYellow, 0, kScale);
  EXPECT_EQ(Extent(image, IsRed, 0, kScale).count, 0u);
  EXPECT_GT(flexor.count, 400u);  // 0.1
  EXPECT_GT(slack.count, 100u);   // 0.6
  EXPECT_GT(slack.bottom, flexor.bottom + 50);
  options.colour = "length";  // a value of the flexor only
  const Extent plain(DrawObjects(options, 1), IsRed, 0, kScale);
  EXPECT_NEAR(plain.x(), slack.x(), 3);
  EXPECT_NEAR(plain.y(), slack.y(), 3);
  options.colour = "tension";
  try {
    DrawObjects(options, 1);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("of lines: activation, length"));
  }
}

// Beside bodies, in panels and in animations.
TEST_F(ObjectsTest, EveryPictureHasThem) {
  v1::Geometry geometry = job_.geometry();
  geometry.MergeFrom(SampleObjects());
  std::vector<v1::Frame> frames;
  for (const int index : {0, 1}) {
    v1::Frame& frame = frames.emplace_back(job_.frame(index));
    const v1::Frame objects = SampleObjectsFrame(index);
    frame.set_poses(objects.poses());
    *frame.mutable_lines() = objects.lines();
  }
  PictureOptions options = FromAbove();
  options.azimuth = -60;
  options.elevation = 30;
  options.rest_outline = false;
  options.size = {800, 300};
  for (const char* style : {"surface", "volume"}) {
    options.colour = "displacement";
    options.volume = std::string(style) == "volume";
    options.surface = !options.volume;
    const std::string path = folder_ / "panels.png";
    DrawPanels(geometry, frames, options, path);
    const Image image = ReadPng(path);
    for (const bool left : {true, false}) {
      std::size_t bone = 0, red = 0;
      for (int y = 0; y < image.height; ++y) {
        for (int x = left ? 0 : 285; x < (left ? 285 : 565); ++x) {
          const Pixel& p = image.pixels[static_cast<std::size_t>(y * image.width + x)];
          bone += IsBone(p);
          red += IsRed(p);
        }
      }
      EXPECT_GT(bone, 100u) << style << left;
      EXPECT_GT(red, 100u) << style << left;
    }
  }
  const std::string path = folder_ / "objects.gif";
  DrawAnimation(geometry, frames, options, {.frames_per_second = 5, .turntable = 0}, path);
  int error = 0;
  GifFileType* gif = DGifOpenFileName(path.c_str(), &error);
  ASSERT_NE(gif, nullptr);
  ASSERT_EQ(DGifSlurp(gif), GIF_OK);
  ASSERT_EQ(gif->ImageCount, 2);
  for (int i = 0; i < 2; ++i) {
    const SavedImage& image = gif->SavedImages[i];
    const ColorMapObject* colours = image.ImageDesc.ColorMap != nullptr ? image.ImageDesc.ColorMap : gif->SColorMap;
    std::size_t bone = 0;
    for (int p = 0; p < 800 * 300; ++p) {
      const GifColorType& c = colours->Colors[image.RasterBits[p]];
      bone += IsBone({c.Red, c.Green, c.Blue});
    }
    EXPECT_GT(bone, 200u) << i;
  }
  DGifCloseFile(gif, &error);
}

// A plane does not determine the size of the picture: it fills it from above and is transparent from below.
TEST_F(ObjectsTest, PlanesAreBehindEverything) {
  v1::Geometry geometry = SampleObjects();
  const Pose pose = {Vec3(0, -0.15, 0), {std::sqrt(0.5), -std::sqrt(0.5), 0, 0}};  // its z axis is y
  v1::RigidBodyGeometry& plane = AddRigidBody("plane", pose, false, geometry);
  plane.set_positions(Bytes(std::vector<double>{-9, -9, 0, 9, -9, 0, 9, 9, 0, -9, 9, 0}));
  plane.set_triangles(Bytes(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  plane.set_unbounded(true);
  const auto draw = [&](const PictureOptions& options) {
    const std::string path = folder_ / "plane.png";
    DrawPicture(geometry, SampleObjectsFrame(1), options, path);
    return ReadPng(path);
  };
  PictureOptions options = Small();
  options.colour = "";
  options.time = false;
  const std::size_t all = 400 * 300;
  EXPECT_GT(draw(options).Count(IsBone), 8 * all / 10) << "seen from above its side unless the view is given";
  options.elevation = -90;
  EXPECT_LT(draw(options).Count(IsBone), 4 * all / 10) << "angles are about the floor's normal";
  options.up = Vec3::UnitZ();
  options.azimuth = 0;
  options.elevation = 90;
  EXPECT_NEAR(static_cast<double>(draw(options).Count(IsRed)),
              static_cast<double>(DrawObjects(options, 1).Count(IsRed)), 60)
      << "at the same scale as without";
}

// A tall scene above a floor is drawn upright, not across the picture as a slender body.
TEST_F(ObjectsTest, WhatFallsIsDrawnUpright) {
  v1::Geometry geometry = SampleObjects();
  const Pose pose = {Vec3(0, -0.15, 0), {std::sqrt(0.5), -std::sqrt(0.5), 0, 0}};  // its z axis is y
  AddRigidBody("plane", pose, false, geometry).set_unbounded(true);
  std::vector<v1::Frame> frames;
  for (const double height : {0.0, 1.0}) {
    v1::Frame& frame = frames.emplace_back(SampleObjectsFrame(0));
    frame.clear_lines();
    AddLine({}, {0, 0}, frame);
    AddLine({Vec3(-0.1, height, 0), Vec3(0.1, height, 0)}, {0}, frame);
  }
  PictureOptions options = Small();
  options.size = {800, 300};
  options.colour = "";
  options.time = false;
  const std::string path = folder_ / "fall.png";
  DrawPanels(geometry, frames, options, path);
  const Image image = ReadPng(path);
  const Extent low(image, IsRed, 0, 400), high(image, IsRed, 400);
  EXPECT_GT(high.y(), low.y() + 100);
  EXPECT_NEAR(high.x() - 400, low.x(), 3);
}

TEST_F(ObjectsTest, AFrameWithNothingToSeeIsRefused) {
  PictureOptions options = FromAbove();
  options.rigid_bodies = false;
  options.lines = false;
  EXPECT_THROW(DrawObjects(options, 1), std::runtime_error);
}

TEST_F(RenderTest, RefusesSizesThatNoOneWants) {
  PictureOptions options = Small();
  options.size = {100000, 10};
  EXPECT_THROW(Draw(options), std::runtime_error);
}

TEST_F(RenderTest, PlotsHaveALineForEachSeries) {
  PlotPanel panel{"title", "time [s]", "energy [J]", {{"a", {0, 1, 2}, {0, 1, 0}}, {"b", {0, 1, 2}, {1, NAN, 1}}}};
  const std::string path = folder_ / "plot.png";
  DrawPlot({panel, panel}, {500, 500}, path);
  const Image image = ReadPng(path);
  EXPECT_EQ(image.height, 500);
  EXPECT_GT(image.Count([](const Pixel& p) { return p[0] < 60 && p[1] > 80 && p[2] > 150; }), 200u) << "blue line";
  EXPECT_GT(image.Count([](const Pixel& p) { return p[0] > 180 && p[1] < 130 && p[2] < 60; }), 100u) << "orange line";
}

TEST_F(RenderTest, LinesThatHardlyChangeAreDrawnToo) {
  const std::string path = folder_ / "plot.png";
  for (const double change : {0.003, 1e-6, 1e-12, 0.0}) {
    DrawPlot({{"", "time [s]", "ratio", {{"a", {0, 1, 2}, {1, 1 + change, 1}}}}}, {400, 300}, path);
    const Image image = ReadPng(path);
    const std::size_t blue = image.Count([](const Pixel& p) { return p[0] < 60 && p[1] > 80 && p[2] > 150; });
    EXPECT_GT(blue, 400u) << change;
  }
}

// Measured values are marks: of a straight line from corner to corner only the ends are drawn.
TEST_F(RenderTest, MeasuredValuesAreMarksWithoutALine) {
  const std::string path = folder_ / "plot.png";
  const auto blue = [&](bool as_points) {
    DrawPlot({{"", "stretch", "stress [kPa]", {{"measured", {1, 2}, {0, 1}, as_points}}}}, {500, 400}, path);
    return ReadPng(path).Count([](const Pixel& p) { return p[0] < 60 && p[1] > 80 && p[2] > 150; });
  };
  const std::size_t marks = blue(true), line = blue(false);
  EXPECT_GT(marks, 30u);
  EXPECT_GT(line, 4 * marks);
}

TEST(RoundTicks, AreRoundAndInside) {
  const Ticks ticks = RoundTicks(0, 0.21, 11);
  EXPECT_EQ(ticks.labels, (std::vector<std::string>{"0.00", "0.02", "0.04", "0.06", "0.08", "0.10", "0.12", "0.14",
                                                    "0.16", "0.18", "0.20"}));
  EXPECT_EQ(RoundTicks(-3, 149.3, 7).labels, (std::vector<std::string>{"0", "50", "100"}));
  EXPECT_EQ(RoundTicks(145.3, 149.3, 7).labels, (std::vector<std::string>{"146", "147", "148", "149"}));
  // Ends that are round count in spite of round-off.
  EXPECT_EQ(RoundTicks(0.1 + 0.2, 0.7 - 1e-16, 5).labels,
            (std::vector<std::string>{"0.3", "0.4", "0.5", "0.6", "0.7"}));
  EXPECT_TRUE(RoundTicks(1, 1, 5).places.empty());
  EXPECT_TRUE(RoundTicks(0, NAN, 5).places.empty());
  for (const double size : {1e-9, 3e-3, 0.7, 12.0, 4.4e8}) {
    const Ticks some = RoundTicks(-0.3 * size, size, 7);
    EXPECT_GE(some.places.size(), 3u) << size;
    EXPECT_LE(some.places.size(), 7u) << size;
  }
}

// A cube seen from a corner: three of its twelve edges are behind, three in front are not on the outline.
TEST(RestOutline, LeavesOutTheBack) {
  BodyShape cube;
  for (int n = 0; n < 8; ++n) cube.positions.emplace_back(n & 1, n >> 1 & 1, n >> 2);
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const auto surface = MakeSurface(*MakeGrid(cube, cube.positions, {}), false);
  ASSERT_EQ(surface->GetNumberOfCells(), 12);
  const Vec3 eye = Vec3(1, 1.1, 0.9).normalized();
  EXPECT_EQ(MakeRestOutline(*surface, eye, true)->GetNumberOfCells(), 9);
  EXPECT_EQ(MakeRestOutline(*surface, eye, false)->GetNumberOfCells(), 6);
}

TEST(VerticalFrame, IsRightHandedAndEndsInTheVertical) {
  for (const Vec3& up : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1),
                         Vec3(0.6, 0, 0.8), Vec3(0, 0.28, 0.96)}) {
    const Mat3 frame = VerticalFrame(up);
    EXPECT_NEAR((frame * frame.transpose() - Mat3::Identity()).norm(), 0, 1e-14) << up.transpose();
    EXPECT_NEAR(frame.determinant(), 1, 1e-14) << up.transpose();
    EXPECT_NEAR((frame.col(2) - up).norm(), 0, 1e-14) << up.transpose();
  }
  // A body that stands along y, as animators have it, faces +z.
  EXPECT_NEAR((VerticalFrame(Vec3::UnitY()) * Vec3(0, -1, 0) - Vec3::UnitZ()).norm(), 0, 1e-14);
}

// The spindle lies along its longest axis; with that axis as the vertical it stands.
TEST_F(RenderTest, TheVerticalCanBeChosen) {
  PictureOptions options = Small();
  options.colour = "";
  options.rest_outline = false;
  options.time = false;
  const auto extent = [](const Image& image) {
    int left = image.width, right = 0, low = image.height, high = 0;
    for (int y = image.height / 6; y < image.height; ++y) {
      for (int x = image.width / 5; x < image.width; ++x) {
        const Pixel& p = image.pixels[static_cast<std::size_t>(y * image.width + x)];
        if (p[0] < p[2] + 60) continue;  // flesh
        left = std::min(left, x), right = std::max(right, x), low = std::min(low, y), high = std::max(high, y);
      }
    }
    return std::pair(right - left, high - low);
  };
  const auto [width, height] = extent(Draw(options));
  options.up = Vec3::UnitZ();
  const auto [upright_width, upright_height] = extent(Draw(options));
  EXPECT_GT(width, height);
  EXPECT_GT(upright_height, upright_width);
}

// A few values far off do not make one colour of all the others, and the note says so.
TEST_F(RenderTest, OutliersDoNotSpoilTheScale) {
  v1::Frame frame = job_.frame(10);
  const std::vector<BodyShape> shapes = DecodeGeometry(job_.geometry());
  const std::size_t count = shapes[0].positions.size();
  ASSERT_GE(count, 200u);
  std::vector<double> values(count);
  for (std::size_t n = 0; n < count; ++n) values[n] = static_cast<double>(n) / static_cast<double>(count);
  v1::FieldValues& field = *frame.mutable_bodies(0)->add_fields();
  field.set_name("strange");
  field.set_location(v1::FieldValues::LOCATION_NODE);
  field.set_components(1);
  field.set_unit("1");
  const auto scale = [&] {
    field.set_values(Bytes(values));
    return ColourFrames(shapes, {}, {}, {&frame, 1}, "strange", std::nullopt)[0];
  };
  EXPECT_EQ(scale().note, "");
  EXPECT_EQ(scale().scale.lowest, 0);
  values[count / 2] = 1000;
  EXPECT_LT(scale().scale.highest, 1.1);
  EXPECT_THAT(scale().note, HasSubstr("0 to 1000"));
}

TEST(SpokenName, WritesNamesOfPeopleAsSuch) {
  EXPECT_EQ(SpokenName("von_mises_stress"), "von Mises stress");
  EXPECT_EQ(SpokenName("cauchy_stress/zz"), "Cauchy stress/zz");
  EXPECT_EQ(SpokenName("green_strain"), "Green strain");
  EXPECT_EQ(SpokenName("degree"), "degree");
}

TEST(ColourScale, CategoriesHaveColoursOfTheirOwn) {
  const ColourScale scale = MakeCategories(4);
  std::set<std::array<double, 3>> colours;
  for (int i = 0; i < 4; ++i) {
    std::array<double, 3> colour;
    scale.table->GetColor(i, colour.data());
    colours.insert(colour);
  }
  EXPECT_EQ(colours.size(), 4u);
}

// A scan of 12 x 10 x 8 voxels with a bright corner at its first voxels, where the body is.
class SlicesTest : public RenderTest {
 protected:
  SlicesTest() {
    input_.size = {12, 10, 8};
    input_.spacing = Vec3::Constant(1e-3);
    values_.assign(12 * 10 * 8, 0.0F);
    labels_.assign(values_.size(), 0);
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          values_[static_cast<std::size_t>(i + 12 * (j + 10 * k))] = 100;
          labels_[static_cast<std::size_t>(i + 12 * (j + 10 * k))] = 1;
        }
      }
    }
    input_.names = {"body"};
  }
  Image DrawScan() {
    input_.values = values_;
    input_.labels = labels_;
    const std::string path = folder_ / "slices.png";
    DrawSlices(input_, {600, 400}, path);
    return ReadPng(path);
  }
  static bool IsWhite(const Pixel& p) { return p[0] > 240 && p[1] > 240 && p[2] > 240; }
  static bool IsOutline(const Pixel& p) { return p[0] > 220 && p[1] > 150 && p[1] < 200 && p[2] < 60; }

  SlicesInput input_;
  std::vector<float> values_;
  std::vector<std::uint8_t> labels_;
};

// An image whose axes run backwards shows the patient the same way round.
TEST_F(SlicesTest, ThePatientIsTheSameWayRound) {
  const Image straight = DrawScan();
  input_.direction = Vec3(-1, -1, -1).asDiagonal();
  std::reverse(values_.begin(), values_.end());
  std::reverse(labels_.begin(), labels_.end());
  const Image reversed = DrawScan();
  std::size_t different = 0;
  for (std::size_t p = 0; p < straight.pixels.size(); ++p) different += straight.pixels[p] != reversed.pixels[p];
  // Only the captions differ, which count voxels.
  EXPECT_LT(different, straight.pixels.size() / 100);
}

TEST_F(SlicesTest, CroppingMagnifiesTheBody) {
  const std::size_t whole = DrawScan().Count(IsOutline);
  input_.crop = 1e-3;
  EXPECT_GT(DrawScan().Count(IsOutline), whole + whole / 4);
}

TEST_F(SlicesTest, TheWindowSaysWhatIsBlackAndWhite) {
  input_.window = {50, 20};
  const std::size_t white = DrawScan().Count(IsWhite);
  input_.window = {200, 20};
  EXPECT_LT(DrawScan().Count(IsWhite), white - 1000) << "the body is black";
}

TEST(ValuesAtNodes, AveragesTetrahedraByVolume) {
  // Nodal averages of a function linear in z are exact in the middle of the body.
  const SampleJob job;
  const BodyShape shape = DecodeGeometry(job.geometry())[0];
  const NodeValues nodes = ValuesAtNodes(shape, job.frame(3).bodies(0), "von_mises_stress");
  EXPECT_EQ(nodes.unit, "Pa");
  for (std::size_t i = 0; i < nodes.values.size(); ++i) {
    const double w = shape.positions[i].z() / SampleJob::kLength;
    EXPECT_NEAR(nodes.values[i], 1000 * w, 1000.0 / SampleJob::kAlong) << i;
  }
}

TEST(ValuesAtNodes, TakesMagnitudesAndComponents) {
  const SampleJob job;
  const BodyShape shape = DecodeGeometry(job.geometry())[0];
  const v1::Frame frame = job.frame(10);
  const NodeValues magnitude = ValuesAtNodes(shape, frame.bodies(0), "displacement");
  const NodeValues x = ValuesAtNodes(shape, frame.bodies(0), "displacement/x");
  const auto positions = DecodePositions(frame.bodies(0), shape.positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_DOUBLE_EQ(magnitude.values[i], (positions[i] - shape.positions[i]).norm());
    EXPECT_DOUBLE_EQ(x.values[i], (positions[i] - shape.positions[i]).x());
  }
}

TEST(ColourScale, ReadableUnits) {
  EXPECT_EQ(MakeReadable(0.012, "m").name, "mm");
  EXPECT_DOUBLE_EQ(MakeReadable(0.012, "m").factor, 1000);
  EXPECT_EQ(MakeReadable(2.5e5, "Pa").name, "kPa");
  EXPECT_EQ(MakeReadable(2500, "m").name, "m");
  EXPECT_EQ(MakeReadable(1.2, "1").name, "");
  EXPECT_EQ(MakeReadable(0, "N").name, "N");
  const ColourScale both = MakeColourScale(-1, 3, false);
  EXPECT_EQ(both.lowest, -3);
  const ColourScale level = MakeColourScale(2, 2, false);
  EXPECT_LT(level.lowest, level.highest);
}

}  // namespace
}  // namespace fascicle::client
