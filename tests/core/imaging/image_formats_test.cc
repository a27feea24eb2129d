// One table of formats x orientations x units: the same asymmetric body, written by hand in every format and read back,
// has the same place, volume and labels.
#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <functional>
#include <iomanip>
#include <set>
#include <sstream>

#include "core/imaging/labels.h"
#include "core/imaging/volume_reader.h"
#include "tests/support/files.h"
#include "tests/support/volume_files.h"

namespace fascicle::testing {
namespace {

using std::filesystem::path;

// How a file is written. A stored number n stands for the value slope * n + intercept.
struct Writing {
  std::string unit;  // as the format writes it
  double metres;     // of that unit
  double slope = 1, intercept = 0;
};

constexpr int kLabelHook = 3, kLabelRest = 5;

// A hook of label 3 and a part of label 5, which no turn or reflection maps to itself.
VolumeImage HookIn(const Mat3& direction) {
  VolumeImage image;
  image.size = {9, 8, 7};
  image.spacing = {0.5e-3, 0.75e-3, 2e-3};
  image.origin = {-61e-3, 43e-3, 117e-3};
  image.direction = direction;
  image.values.assign(image.voxels(), 0);
  const auto fill = [&](GridIndex from, GridIndex to, int label) {
    for (std::int32_t k = from[2]; k < to[2]; ++k) {
      for (std::int32_t j = from[1]; j < to[1]; ++j) {
        for (std::int32_t i = from[0]; i < to[0]; ++i)
          image.values[image.IndexOf({i, j, k})] = static_cast<float>(label);
      }
    }
  };
  fill({1, 1, 1}, {3, 7, 5}, kLabelHook);
  fill({3, 1, 1}, {7, 3, 3}, kLabelHook);
  fill({6, 5, 4}, {8, 7, 6}, kLabelRest);
  return image;
}

// The stored numbers, little-endian shorts.
std::string Stored(const VolumeImage& image, const Writing& writing) {
  std::string bytes;
  for (const float value : image.values) {
    bytes += Number(static_cast<std::int16_t>(std::lround((value - writing.intercept) / writing.slope)));
  }
  return bytes;
}

std::string Numbers(const Vec3& v, const char* separator = " ") {
  std::ostringstream text;
  text << std::setprecision(12) << v[0] << separator << v[1] << separator << v[2];
  return text.str();
}

std::string Sizes(const VolumeImage& image) {
  return std::to_string(image.size[0]) + " " + std::to_string(image.size[1]) + " " + std::to_string(image.size[2]);
}

std::string Zlib(const std::string& bytes, bool gzip) {
  z_stream stream = {};
  deflateInit2(&stream, 6, Z_DEFLATED, gzip ? 15 + 16 : 15, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

// [MetaIO documentation]
std::string MetaText(const VolumeImage& image, const Writing& writing, const std::string& more,
                     const std::string& file) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" + more +
         "TransformMatrix = " + Numbers(image.direction.col(0)) + " " + Numbers(image.direction.col(1)) + " " +
         Numbers(image.direction.col(2)) + "\nOffset = " + Numbers(image.origin / writing.metres) +
         "\nElementSpacing = " + Numbers(image.spacing / writing.metres) + "\nDistanceUnits = " + writing.unit +
         "\nElementToIntensityFunctionSlope = " + std::to_string(writing.slope) +
         "\nElementToIntensityFunctionOffset = " + std::to_string(writing.intercept) + "\nDimSize = " + Sizes(image) +
         "\nElementType = MET_SHORT\nElementDataFile = " + file + "\n";
}

// [Definition of NRRD file format] in a space whose axes have these signs along left, posterior and superior.
std::string NrrdText(const VolumeImage& image, const Writing& writing, const std::string& space, const Vec3& signs,
                     const std::string& more) {
  const auto vector = [&](const Vec3& v) { return "(" + Numbers(signs.cwiseProduct(v) / writing.metres, ",") + ")"; };
  std::string text =
      "NRRD0005\ntype: short\ndimension: 3\nsizes: " + Sizes(image) + "\nspace: " + space + "\nspace units:";
  for (int axis = 0; axis < 3; ++axis) text += " \"" + writing.unit + "\"";
  text += "\nspace directions:";
  for (int axis = 0; axis < 3; ++axis) text += " " + vector(image.spacing[axis] * image.direction.col(axis));
  return text + "\nspace origin: " + vector(image.origin) + "\nendian: little\n" + more + "\n";
}

// [nifti1.h, nifti2.h] as an sform or a qform. `magic` is "n+1", "ni1" or "n+2".
std::string NiftiHeaderBytes(const VolumeImage& image, const Writing& writing, bool sform, const std::string& magic) {
  const bool second = magic == "n+2";
  std::string bytes(second ? 544 : magic == "ni1" ? 348 : 352, '\0');
  const auto put = [&](std::size_t at, const std::string& text) { bytes.replace(at, text.size(), text); };
  const auto real = [&](double value) { return second ? Number(value) : Number(static_cast<float>(value)); };
  const auto whole = [&](int value) {
    return second ? Number(static_cast<std::int64_t>(value)) : Number(static_cast<std::int16_t>(value));
  };
  const auto code = [&](int value) {
    return second ? Number(static_cast<std::int32_t>(value)) : Number(static_cast<std::int16_t>(value));
  };
  put(0, Number(static_cast<std::int32_t>(second ? 540 : 348)));
  put(second ? 4 : 344, magic + std::string(1, '\0'));
  put(second ? 16 : 40, whole(3) + whole(image.size[0]) + whole(image.size[1]) + whole(image.size[2]) + whole(1) +
                            whole(1) + whole(1) + whole(1));
  put(second ? 12 : 70, Number(std::int16_t{4}) + Number(std::int16_t{16}));
  const Vec3 signs(-1, -1, 1);
  Mat3 axes = signs.asDiagonal() * image.direction;
  const double qfac = axes.determinant() < 0 ? -1 : 1;
  const Vec3 spacing = image.spacing / writing.metres, origin = signs.cwiseProduct(image.origin) / writing.metres;
  put(second ? 104 : 76, real(qfac) + real(spacing[0]) + real(spacing[1]) + real(spacing[2]));
  put(second ? 168 : 108, second ? Number(std::int64_t{544}) : real(magic == "ni1" ? 0 : 352));
  put(second ? 176 : 112, real(writing.slope) + real(writing.intercept));
  const int unit = writing.unit == "m" ? 1 : writing.unit == "mm" ? 2 : 3;
  put(second ? 500 : 123, second ? Number(static_cast<std::int32_t>(unit)) : std::string(1, static_cast<char>(unit)));
  put(second ? 344 : 252, code(sform ? 0 : 1) + code(sform ? 1 : 0));
  if (sform) {
    std::string rows;
    for (int row = 0; row < 3; ++row) {
      for (int axis = 0; axis < 3; ++axis) rows += real(axes(row, axis) * spacing[axis]);
      rows += real(origin[row]);
    }
    put(second ? 400 : 280, rows);
    return bytes;
  }
  axes.col(2) *= qfac;
  Eigen::Quaterniond q(axes);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  put(second ? 352 : 256,
      real(q.x()) + real(q.y()) + real(q.z()) + real(origin[0]) + real(origin[1]) + real(origin[2]));
  return bytes;
}

// A series of slices; those of a left-handed image are stacked against their normal.
std::vector<path> WriteSeries(const TemporaryFolder& folder, const VolumeImage& image, const Writing& writing) {
  std::vector<path> paths;
  const std::size_t count = static_cast<std::size_t>(image.size[0]) * image.size[1];
  for (std::int32_t k = 0; k < image.size[2]; ++k) {
    DicomSlice slice;
    slice.columns = image.size[0];
    slice.rows = image.size[1];
    slice.position = Numbers(image.CentreOf({0, 0, k}) * 1e3, "\\");
    slice.orientation = Numbers(image.direction.col(0), "\\") + "\\" + Numbers(image.direction.col(1), "\\");
    slice.spacing = std::to_string(image.spacing[1] * 1e3) + "\\" + std::to_string(image.spacing[0] * 1e3);
    slice.slope = std::to_string(writing.slope);
    slice.intercept = std::to_string(writing.intercept);
    slice.first_value = k;
    for (std::size_t v = k * count; v < (k + 1) * count; ++v) {
      slice.voxels.push_back(static_cast<int>(std::lround((image.values[v] - writing.intercept) / writing.slope)));
    }
    paths.push_back(folder.Write("slice" + std::to_string(k) + ".dcm", DicomBytes(slice)));
  }
  return paths;
}

using Writer = std::function<std::vector<path>(const TemporaryFolder&, const VolumeImage&, const Writing&)>;

struct Format {
  std::string name;
  std::vector<Writing> writings;
  Writer write;
};

std::vector<Format> Formats() {
  const std::vector<Writing> nifti = {{"mm", 1e-3}, {"um", 1e-6}, {"m", 1}, {"mm", 1e-3, 0.5, -3}};
  const std::vector<Writing> nrrd = {{"mm", 1e-3}, {"um", 1e-6}, {"cm", 1e-2}, {"m", 1}};
  const std::vector<Writing> meta = {{"mm", 1e-3}, {"um", 1e-6}, {"cm", 1e-2}, {"mm", 1e-3, 0.5, -3}};
  const auto one = [](const char* name, auto bytes) -> Writer {
    return [name, bytes](const TemporaryFolder& folder, const VolumeImage& image, const Writing& writing) {
      return std::vector<path>{folder.Write(name, bytes(image, writing))};
    };
  };
  const auto with_raw = [](const char* name, const char* raw, auto header) -> Writer {
    return [=](const TemporaryFolder& folder, const VolumeImage& image, const Writing& writing) {
      folder.Write(raw, Stored(image, writing));
      return std::vector<path>{folder.Write(name, header(image, writing))};
    };
  };
  const Vec3 lps(1, 1, 1), ras(-1, -1, 1), las(1, -1, 1);
  const auto in_space = [&](const char* name, const Vec3& signs) {
    return one("a.nrrd", [name, signs](const VolumeImage& image, const Writing& writing) {
      return NrrdText(image, writing, name, signs, "encoding: raw\n") + Stored(image, writing);
    });
  };
  return {
      {"NIfTI, sform", nifti,
       one("a.nii", [](const auto& i, const auto& w) { return NiftiHeaderBytes(i, w, true, "n+1") + Stored(i, w); })},
      {"NIfTI, qform", nifti,
       one("a.nii", [](const auto& i, const auto& w) { return NiftiHeaderBytes(i, w, false, "n+1") + Stored(i, w); })},
      {"NIfTI-2", nifti,
       one("a.nii", [](const auto& i, const auto& w) { return NiftiHeaderBytes(i, w, true, "n+2") + Stored(i, w); })},
      {".nii.gz", nifti,
       one("a.nii.gz", [](const auto& i,
                          const auto& w) { return Zlib(NiftiHeaderBytes(i, w, true, "n+1") + Stored(i, w), true); })},
      {".hdr and .img", nifti,
       with_raw("a.hdr", "a.img", [](const auto& i, const auto& w) { return NiftiHeaderBytes(i, w, true, "ni1"); })},
      {"NRRD, LPS", nrrd, in_space("left-posterior-superior", lps)},
      {"NRRD, RAS", nrrd, in_space("right-anterior-superior", ras)},
      {"NRRD, LAS", nrrd, in_space("LAS", las)},
      {"NRRD, gzip", nrrd,
       one("a.nrrd",
           [lps](const auto& i, const auto& w) {
             return NrrdText(i, w, "LPS", lps, "encoding: gzip\n") + Zlib(Stored(i, w), true);
           })},
      {"NHDR", nrrd,
       with_raw("a.nhdr", "a.raw",
                [lps](const auto& i, const auto& w) {
                  return NrrdText(i, w, "LPS", lps, "encoding: raw\ndata file: ./a.raw\n");
                })},
      {"MHA", meta,
       one("a.mha", [](const auto& i, const auto& w) { return MetaText(i, w, "", "LOCAL") + Stored(i, w); })},
      {"MHA, compressed", meta,
       one("a.mha",
           [](const auto& i, const auto& w) {
             return MetaText(i, w, "CompressedData = True\n", "LOCAL") + Zlib(Stored(i, w), false);
           })},
      {"MHD", meta,
       with_raw("a.mhd", "a.raw", [](const auto& i, const auto& w) { return MetaText(i, w, "", "a.raw"); })},
      {"DICOM series", {{"mm", 1e-3}, {"mm", 1e-3, 0.5, -3}}, WriteSeries},
  };
}

std::vector<std::pair<std::string, Mat3>> Orientations() {
  Mat3 turned, exchanged;
  turned << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  exchanged << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  const Mat3 oblique = Eigen::AngleAxisd(0.4, Vec3(1, 2, -3).normalized()).toRotationMatrix();
  const Mat3 flip_x = Vec3(-1, 1, 1).asDiagonal(), flip_xy = Vec3(-1, -1, 1).asDiagonal();
  return {{"identity", Mat3::Identity()}, {"flip x", flip_x},
          {"flip x, y", flip_xy},         {"flip all", -Mat3::Identity()},
          {"axes turned", turned},        {"x and y exch.", exchanged},
          {"oblique", oblique},           {"oblique, left", oblique * flip_x}};
}

// The largest distance [mm] between the place of a voxel that is read and that of the voxel written there with the same
// value; infinite if there is none. The order of voxels in memory does not matter.
double PlaceError(const VolumeImage& read, const VolumeImage& written) {
  double largest = 0;
  std::set<std::size_t> met;
  for (std::int32_t k = 0; k < read.size[2]; ++k) {
    for (std::int32_t j = 0; j < read.size[1]; ++j) {
      for (std::int32_t i = 0; i < read.size[0]; ++i) {
        const Vec3 place = read.CentreOf({i, j, k});
        const GridIndex at = written.VoxelAt(place);
        if (!written.Contains(at) || read.values[read.IndexOf({i, j, k})] != written.values[written.IndexOf(at)]) {
          return HUGE_VAL;
        }
        met.insert(written.IndexOf(at));
        largest = std::max(largest, 1e3 * (place - written.CentreOf(at)).norm());
      }
    }
  }
  return met.size() == written.voxels() ? largest : HUGE_VAL;
}

double VolumeOfHook(const VolumeImage& image) {
  double voxels = 0;
  for (const float value : image.values) voxels += HasLabel(value, kLabelHook) ? 1 : 0;
  return voxels * image.voxel_volume() * 1e9;
}

TEST(ImageFormats, KeepPlaceVolumeAndLabels) {
  const double volume = (2 * 6 * 4 + 4 * 2 * 2) * 0.75;
  int combinations = 0;
  std::printf("largest error of a voxel's place [mm]\n%-34s", "format, unit, slope");
  for (const auto& [name, direction] : Orientations()) std::printf(" %13s", name.c_str());
  std::printf("\n");
  for (const Format& format : Formats()) {
    for (const Writing& writing : format.writings) {
      std::printf("%-16s %-3s %4.1f n %+4.1f    ", format.name.c_str(), writing.unit.c_str(), writing.slope,
                  writing.intercept);
      for (const auto& [name, direction] : Orientations()) {
        const VolumeImage written = HookIn(direction);
        const TemporaryFolder folder;
        Problems problems;
        const auto read = ReadVolumeFiles(format.write(folder, written, writing), {}, problems);
        ASSERT_TRUE(read) << format.name << ", " << name << ": " << problems.ToString();
        const double error = PlaceError(*read, written);
        EXPECT_LT(error, 1e-3) << format.name << ", " << writing.unit << ", " << name;
        EXPECT_NEAR(VolumeOfHook(*read) / volume, 1, 1e-6) << format.name << ", " << writing.unit << ", " << name;
        EXPECT_TRUE(read->notes.empty()) << format.name << ": " << read->notes[0];
        std::printf(" %13.1e", error);
        ++combinations;
      }
      std::printf("\n");
    }
  }
  std::printf("%d combinations, %.0f mm^3 each\n", combinations, volume);
  EXPECT_GE(combinations, 60);
}

}  // namespace
}  // namespace fascicle::testing
