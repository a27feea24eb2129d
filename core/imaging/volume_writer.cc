#include "core/imaging/volume_writer.h"

#include <unistd.h>

#include <system_error>

#include "core/base/letters.h"
#include "core/imaging/itk_image_writer.h"

namespace fascicle {

void WriteVolume(const VolumeImage& image, VoxelType type, const std::filesystem::path& path, Problems& problems) {
  const std::string name = path.filename().string();
  const std::optional<VolumeFormat> format = FormatOf(name);
  if (!format || IsDetachedHeader(name) || *format == VolumeFormat::kDicom || *format == VolumeFormat::kRaw) {
    problems.Add("", name + " is not an image format that can be written",
                 "its name must end in .mha, .nrrd, .nii or .nii.gz");
    return;
  }
  // ITK chooses the format by the extension, in lower case.
  const std::string beside_name = Lower("." + std::to_string(getpid()) + "." + name);
  const std::filesystem::path beside = path.parent_path() / beside_name;
  std::error_code error;
  const bool written = WriteByItk(image, type, *format, beside);
  if (written) std::filesystem::rename(beside, path, error);
  if (!written || error) {
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    problems.Add("", "it can't be written", "does the folder exist, may it be written to, and is there room?");
  }
}

}  // namespace fascicle
