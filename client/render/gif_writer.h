#ifndef FASCICLE_CLIENT_RENDER_GIF_WRITER_H_
#define FASCICLE_CLIENT_RENDER_GIF_WRITER_H_

#include <vtkImageData.h>

#include <filesystem>
#include <string>

#include "client/render/canvas.h"

struct GifFileType;

namespace fascicle::client {

// Collects pictures of one size to an animated GIF that repeats, each with its own 256 colours.
class GifWriter {
 public:
  // Throws std::runtime_error with a message for users, like the other functions.
  GifWriter(PictureSize size, double frames_per_second);
  ~GifWriter();
  GifWriter(const GifWriter&) = delete;
  GifWriter& operator=(const GifWriter&) = delete;

  // Red, green and blue of each pixel, lowest row first, as returned by Canvas.
  void Add(vtkImageData& picture);
  // Writes the file atomically. Nothing may be added afterwards.
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
