#include "server/translate/kept_results.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <span>

namespace fascicle::server {
namespace {

void PutNotes(const std::vector<std::string>& notes, ArchiveWriter& archive) {
  archive.PutInt("notes", static_cast<std::int64_t>(notes.size()));
  for (const std::string& note : notes) archive.PutString("note", note);
}

void GetNotes(ArchiveReader& archive, std::vector<std::string>& notes) {
  const std::int64_t count = archive.GetInt("notes");
  for (std::int64_t i = 0; i < count && !archive.failed(); ++i) notes.push_back(archive.GetString("note"));
}

}  // namespace

void SegmentedImage::WriteTo(ArchiveWriter& archive) const {
  archive.PutInts("size", grid.size);
  archive.PutDoubles("spacing", {grid.spacing.data(), 3});
  archive.PutDoubles("origin", {grid.origin.data(), 3});
  archive.PutDoubles("direction", {grid.direction.data(), 9});
  archive.PutString("material", {reinterpret_cast<const char*>(grid.material.data()), grid.material.size()});
  PutNotes(notes, archive);
}

void SegmentedImage::ReadFrom(ArchiveReader& archive) {
  archive.GetInts("size", std::span(grid.size));
  archive.GetDoubles("spacing", std::span(grid.spacing.data(), 3));
  archive.GetDoubles("origin", std::span(grid.origin.data(), 3));
  archive.GetDoubles("direction", std::span(grid.direction.data(), 9));
  const std::string material = archive.GetString("material");
  grid.material.assign(material.begin(), material.end());
  if (grid.material.size() != grid.voxels()) archive.Fail();
  GetNotes(archive, notes);
}

void ComputedFibres::WriteTo(ArchiveWriter& archive) const {
  archive.PutVectors("fibres", fibres);
  PutNotes(notes, archive);
}

void ComputedFibres::ReadFrom(ArchiveReader& archive) {
  archive.GetVectors("fibres", fibres);
  GetNotes(archive, notes);
}

void PutMessage(const char* name, const google::protobuf::Message& message, ArchiveWriter& inputs) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&coded);
  }
  inputs.PutString(name, bytes);
}

void PutMesh(const TetMesh& mesh, ArchiveWriter& inputs) {
  static_assert(sizeof(Tetrahedron) == 4 * sizeof(std::int32_t));
  inputs.PutVectors("nodes", mesh.nodes);
  const std::int32_t* const corners = mesh.tetrahedra.empty() ? nullptr : mesh.tetrahedra[0].data();
  inputs.PutInts("tetrahedra", {corners, 4 * mesh.tetrahedra.size()});
}

}  // namespace fascicle::server
