#include "client/render/gif_writer.h"

#include <gif_lib.h>
#include <vtkImageQuantizeRGBToIndex.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "client/lib/replace_file.h"

namespace fascicle::client {
namespace {

constexpr int kPaletteColours = 256;

void Check(int result) {
  if (result != GIF_OK) throw std::runtime_error("the GIF could not be made");
}

int Append(GifFileType* file, const GifByteType* bytes, int count) {
  static_cast<std::string*>(file->UserData)
      ->append(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count));
  return count;
}

}  // namespace

GifWriter::GifWriter(PictureSize size, double frames_per_second)
    : size_(size), delay_(std::max(2, static_cast<int>(std::lround(100 / frames_per_second)))) {
  int error = 0;
  file_ = EGifOpen(&bytes_, Append, &error);
  if (file_ == nullptr) throw std::runtime_error("the GIF could not be made");
  EGifSetGifVersion(file_, true);
  Check(EGifPutScreenDesc(file_, size.width, size.height, 8, 0, nullptr));
  // Repeats indefinitely.
  const std::array<GifByteType, 3> forever = {1, 0, 0};
  Check(EGifPutExtensionLeader(file_, APPLICATION_EXT_FUNC_CODE));
  Check(EGifPutExtensionBlock(file_, 11, "NETSCAPE2.0"));
  Check(EGifPutExtensionBlock(file_, 3, forever.data()));
  Check(EGifPutExtensionTrailer(file_));
}

GifWriter::~GifWriter() { Close(); }

void GifWriter::Close() {
  int error = 0;
  if (file_ != nullptr) EGifCloseFile(file_, &error);
  file_ = nullptr;
}

void GifWriter::Add(vtkImageData& picture) {
  vtkNew<vtkImageQuantizeRGBToIndex> quantize;
  quantize->SetInputData(&picture);
  quantize->SetNumberOfColors(kPaletteColours);
  quantize->Update();
  vtkLookupTable& table = *quantize->GetLookupTable();
  std::array<GifColorType, kPaletteColours> colours = {};
  for (vtkIdType i = 0; i < std::min<vtkIdType>(kPaletteColours, table.GetNumberOfTableValues()); ++i) {
    const double* rgba = table.GetTableValue(i);
    const auto byte = [](double part) {
      return static_cast<GifByteType>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
    };
    colours[static_cast<std::size_t>(i)] = {byte(rgba[0]), byte(rgba[1]), byte(rgba[2])};
  }
  const GraphicsControlBlock control = {DISPOSE_DO_NOT, false, delay_, NO_TRANSPARENT_COLOR};
  std::array<GifByteType, 4> block = {};
  EGifGCBToExtension(&control, block.data());
  Check(EGifPutExtension(file_, GRAPHICS_EXT_FUNC_CODE, 4, block.data()));
  ColorMapObject* map = GifMakeMapObject(kPaletteColours, colours.data());
  if (map == nullptr) throw std::runtime_error("the GIF could not be made");
  const int described = EGifPutImageDesc(file_, 0, 0, size_.width, size_.height, false, map);
  GifFreeMapObject(map);
  Check(described);
  vtkImageData& indices = *quantize->GetOutput();
  std::vector<GifByteType> line(static_cast<std::size_t>(size_.width));
  for (int y = size_.height - 1; y >= 0; --y) {
    for (int x = 0; x < size_.width; ++x) {
      line[static_cast<std::size_t>(x)] = static_cast<GifByteType>(indices.GetScalarComponentAsDouble(x, y, 0, 0));
    }
    Check(EGifPutLine(file_, line.data(), size_.width));
  }
}

void GifWriter::Save(const std::filesystem::path& path) {
  Close();
  ReplaceFile(path, bytes_);
}

}  // namespace fascicle::client
