#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>

#include "child_process.h"
#include "client/render/colour_scale.h"
#include "client/render/field_values.h"
#include "client/render/picture.h"
#include "client/render/plot.h"
#include "sample_job.h"

namespace fascicle::client {
namespace {

using ::fascicle::testing::SampleJob;
using ::fascicle::testing::ScratchFolder;
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
  ScratchFolder folder_;
};

TEST_F(RenderTest, ShowsTheBellyInTheColoursOfItsField) {
  const Image image = Draw(Small());
  EXPECT_EQ(image.width, 400);
  EXPECT_EQ(image.height, 300);
  EXPECT_GT(image.Colours(), 500u);
  // The belly moves most, the ends least, and both are a good part of the picture.
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

TEST(ValuesAtNodes, AveragesTetrahedraByVolume) {
  // A linear function of z has averages that follow it in the middle of the body.
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
