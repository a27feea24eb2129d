#ifndef FASCICLE_CLIENT_RENDER_GIF_WRITER_H_
#define FASCICLE_CLIENT_RENDER_GIF_WRITER_H_

#include <vtkImageData.h>

#include <filesystem>
#include <string>

#include "client/render/canvas.h"

struct GifFileType;

namespace fascicle::client {

// Collects pictures of one size as an animated GIF that repeats, each with 256 colours of its own.
class GifWriter {
 public:
  // Throws std::runtime_error with a message for people, as do the others.
  GifWriter(PictureSize size, double frames_per_second);
  ~GifWriter();
  GifWriter(const GifWriter&) = delete;
  GifWriter& operator=(const GifWriter&) = delete;

  // Red, green and blue of each pixel, the lowest row first, as Canvas gives it.
  void Add(vtkImageData& picture);
  // Writes the file, whole or not at all. Nothing may be added after.
  void Save(const std::filesystem::path& path);

 private:
  void Close();

  PictureSize size_;
  int delay_;  // [0.01 s]
  std::string bytes_;
  GifFileType* file_ = nullptr;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_GIF_WRITER_H_
