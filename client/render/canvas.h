#ifndef FASCICLE_CLIENT_RENDER_CANVAS_H_
#define FASCICLE_CLIENT_RENDER_CANVAS_H_

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <memory>

#include "client/render/display.h"

namespace fascicle::client {

// Size of a picture [pixel].
struct PictureSize {
  int width = 1200;
  int height = 900;
};

// An off-screen drawing surface that is saved as PNG. It is drawn at twice the size and downsampled, so that edges and
// thin lines are smooth. Multiply line widths and positions in pixels by kSampling; text scales automatically. One
// object at a time in a process, from one thread.
class Canvas {
 public:
  static constexpr int kSampling = 2;

  // 16 to 8,192 pixels per side. Throws std::runtime_error if there is no display to draw on.
  explicit Canvas(PictureSize size);

  vtkRenderWindow& window() { return *window_; }
  int width() const { return size_.width * kSampling; }    // [pixel drawn]
  int height() const { return size_.height * kSampling; }  // [pixel drawn]

  // Draws and writes the file atomically. Throws std::runtime_error with a message for users.
  void Save(const std::filesystem::path& path);
  // Writes a picture as Grab returns it, likewise.
  static void SavePng(vtkImageData& picture, const std::filesystem::path& path);
  // Draws and returns the picture: red, green and blue of each pixel, lowest row first.
  vtkSmartPointer<vtkImageData> Grab();
  // Removes everything, for the next picture.
  void Clear();

 private:
  PictureSize size_;
  std::shared_ptr<Display> display_;  // outlives the window
  vtkNew<vtkRenderWindow> window_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_CANVAS_H_
