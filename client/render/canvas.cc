#include "client/render/canvas.h"

#include <vtkImageShrink3D.h>
#include <vtkPNGWriter.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <stdexcept>
#include <string_view>

#include "client/lib/replace_file.h"

namespace fascicle::client {
namespace {

PictureSize Checked(PictureSize size) {
  constexpr int kSmallest = 16, kLargest = 8192;
  if (size.width < kSmallest || size.height < kSmallest || size.width > kLargest || size.height > kLargest) {
    throw std::runtime_error("a picture has 16 to 8192 pixels per side");
  }
  return size;
}

}  // namespace

Canvas::Canvas(PictureSize size) : size_(Checked(size)), display_(Display::Open()) {
  window_->SetDisplayId(display_->native());
  window_->SetShowWindow(false);
  window_->UseOffScreenBuffersOn();
  window_->SetMultiSamples(0);  // downsampling replaces it, and transparency requires it off
  window_->SetAlphaBitPlanes(1);
  window_->SetDPI(72 * kSampling);
  window_->SetSize(width(), height());
}

void Canvas::Clear() {
  vtkRendererCollection& renderers = *window_->GetRenderers();
  while (vtkRenderer* renderer = renderers.GetFirstRenderer()) window_->RemoveRenderer(renderer);
}

vtkSmartPointer<vtkImageData> Canvas::Grab() {
  window_->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window_);
  grab->SetInputBufferTypeToRGB();
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  vtkNew<vtkImageShrink3D> average;
  average->SetInputConnection(grab->GetOutputPort());
  average->SetShrinkFactors(kSampling, kSampling, 1);
  average->AveragingOn();
  average->Update();
  return average->GetOutput();
}

void Canvas::Save(const std::filesystem::path& path) { SavePng(*Grab(), path); }

void Canvas::SavePng(vtkImageData& picture, const std::filesystem::path& path) {
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(&picture);
  writer->WriteToMemoryOn();
  writer->SetCompressionLevel(2);  // much faster than the default, with hardly larger files
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  if (bytes == nullptr || bytes->GetNumberOfValues() == 0) throw std::runtime_error("the picture could not be drawn");
  ReplaceFile(path, std::string_view(reinterpret_cast<const char*>(bytes->GetPointer(0)),
                                     static_cast<std::size_t>(bytes->GetNumberOfValues())));
}

}  // namespace fascicle::client
