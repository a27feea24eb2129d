#include "client/export/vtk_series.h"

#include <charconv>
#include <cstdio>
#include <pugixml.hpp>
#include <sstream>
#include <stdexcept>

#include "client/export/vtk_files.h"
#include "client/lib/replace_file.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

// The name of an object's file in a frame, without its extension.
std::string FileName(const std::string& object, const v1::Frame& frame) {
  char number[32];
  std::snprintf(number, sizeof number, "%06lld", static_cast<long long>(frame.index()));
  return "frames/" + object + "_" + number;
}

// Shortest text that reads back as the same number.
std::string Exact(double value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

// Names come from the server, which checks them. They must not lead out of the folder in any case.
template <class Objects>
void CheckNames(const Objects& objects) {
  for (const auto& object : objects) {
    if (object.name.empty() || object.name.find('/') != std::string::npos) {
      throw std::runtime_error("the server sent an object with the unusable name \"" + object.name + "\"");
    }
  }
}

}  // namespace

VtkSeriesWriter::VtkSeriesWriter(const v1::Geometry& geometry, fs::path folder)
    : folder_(std::move(folder)),
      bodies_(DecodeGeometry(geometry)),
      rigid_bodies_(DecodeRigidBodies(geometry)),
      lines_(DecodeLineInfos(geometry)) {
  CheckNames(bodies_);
  CheckNames(rigid_bodies_);
  CheckNames(lines_);
}

void VtkSeriesWriter::Add(const v1::Frame& frame) {
  if (static_cast<std::size_t>(frame.bodies_size()) != bodies_.size()) {
    throw std::runtime_error("the server sent a frame that doesn't fit its geometry");
  }
  const bool first = entries_.empty();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const std::string file = FileName(bodies_[i].name, frame) + ".vtu";
    WriteBody(bodies_[i], frame.bodies(static_cast<int>(i)), folder_ / file);
    entries_.push_back({frame.time(), i, bodies_[i].name, file});
  }
  AddRigidBodies(frame, first);
  AddLines(frame);
}

void VtkSeriesWriter::AddRigidBodies(const v1::Frame& frame, bool first) {
  const std::vector<Pose> poses = PosesOf(frame, rigid_bodies_);
  for (std::size_t i = 0; i < rigid_bodies_.size(); ++i) {
    const RigidShape& body = rigid_bodies_[i];
    if (body.triangles.empty()) continue;
    const std::string file =
        (body.moves ? FileName("rigid_" + body.name, frame) : "frames/fixed_" + body.name) + ".vtp";
    if (body.moves || first) WriteRigidBody(body, poses[i], folder_ / file);
    entries_.push_back({frame.time(), bodies_.size() + i, body.name, file});
  }
}

void VtkSeriesWriter::AddLines(const v1::Frame& frame) {
  const std::vector<LinePath> paths = DecodeLines(frame, lines_);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const std::string file = FileName("line_" + lines_[i].name, frame) + ".vtp";
    WriteLine(lines_[i], paths[i], folder_ / file);
    entries_.push_back({frame.time(), bodies_.size() + rigid_bodies_.size() + i, lines_[i].name, file});
  }
}

void VtkSeriesWriter::Finish() const {
  pugi::xml_document document;
  pugi::xml_node root = document.append_child("VTKFile");
  root.append_attribute("type") = "Collection";
  root.append_attribute("version") = "0.1";
  root.append_attribute("byte_order") = "LittleEndian";
  pugi::xml_node collection = root.append_child("Collection");
  for (const Entry& entry : entries_) {
    pugi::xml_node data_set = collection.append_child("DataSet");
    data_set.append_attribute("timestep") = Exact(entry.time).c_str();
    data_set.append_attribute("part") = static_cast<unsigned long long>(entry.part);
    data_set.append_attribute("name") = entry.name.c_str();
    data_set.append_attribute("file") = entry.file.c_str();
  }
  std::ostringstream text;
  document.save(text, "  ");
  ReplaceFile(folder_ / "frames.pvd", text.str());
}

}  // namespace fascicle::client
