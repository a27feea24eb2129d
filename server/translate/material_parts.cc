#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/text_lines.h"
#include "server/translate/materials.h"
#include "server/translate/meshes.h"
#include "server/translate/number_files.h"
#include "server/translate/parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// Indices of the law's parameters that the first line of a file names; nothing where something is wrong with it.
std::optional<std::vector<std::size_t>> ReadColumns(std::string_view line, const LawInfo& law, Problems& problems) {
  std::vector<std::size_t> columns;
  Problems own;
  for (const std::string_view word : Words(line)) {
    const auto found = std::find_if(law.parameters.begin(), law.parameters.end(),
                                    [&](const ParameterInfo& parameter) { return parameter.name == word; });
    const auto column = static_cast<std::size_t>(found - law.parameters.begin());
    if (found == law.parameters.end()) {
      std::string names;
      for (const ParameterInfo& p : law.parameters) names += (names.empty() ? "" : ", ") + std::string(p.name);
      own.Add({}, "the first line: `" + std::string(word.substr(0, 64)) + "` is no parameter of " + law.name,
              "it names columns, of: " + names);
    } else if (std::find(columns.begin(), columns.end(), column) != columns.end()) {
      own.Add({}, "the first line names `" + std::string(word) + "` twice");
    } else {
      columns.push_back(column);
    }
  }
  problems.Append("", own);
  if (!own.empty()) return std::nullopt;
  return columns;
}

// A material for each element, from a file whose first line names the parameters that the others give.
std::vector<Material> ReadMaterials(std::string_view text, const LawInfo& law, std::vector<double> values,
                                    std::size_t elements, Problems& problems) {
  TextLines lines(text);
  if (!lines.Next()) {
    problems.Add({}, "is empty", "its first line names parameters of " + std::string(law.name));
    return {};
  }
  const auto columns = ReadColumns(lines.line(), law, problems);
  if (!columns) return {};
  std::vector<Material> materials;
  std::vector<double> line(columns->size());
  std::size_t count = 0;
  for (; lines.Next(); ++count) {
    const std::string where = "line " + std::to_string(lines.number()) + ": ";
    if (!ParseNumbers(lines.line(), line)) {
      problems.Add({}, where + "not " + std::to_string(line.size()) + " finite numbers with blanks between them");
      continue;
    }
    for (std::size_t k = 0; k < line.size(); ++k) {
      const ParameterInfo& parameter = law.parameters[(*columns)[k]];
      values[(*columns)[k]] = line[k];
      if (InRange(parameter, line[k])) continue;
      problems.Add({}, where + parameter.name + " is " + Text(line[k]) + ", outside the range " + RangeText(parameter),
                   std::string("unit ") + parameter.unit);
    }
    if (problems.empty() && count < elements) materials.push_back(law.make(values));
  }
  CheckLineCount(count, elements, "elements", problems);
  return materials;
}

std::vector<Material> TranslateElementParameters(const v1::Body& body, const std::string& path,
                                                 const TranslatedMesh* mesh, const AssetReader& assets,
                                                 Problems& problems) {
  const auto bytes = ReadFile(body.element_parameters(), path, assets, problems);
  const LawInfo* law = LawOf(body.material());
  if (!bytes || mesh == nullptr || law == nullptr || !ObeysRules(body.material())) return {};
  Problems own;
  std::vector<Material> materials = ReadMaterials(*bytes, *law, ParametersOf(body.material()), mesh->elements(), own);
  problems.Append(path, own);
  return own.empty() ? materials : std::vector<Material>();
}

}  // namespace

void MarkRegion(const std::string& name, const std::string& path, const TranslatedRegions& regions, std::int32_t value,
                std::vector<std::int32_t>& parts, Problems& problems) {
  const auto index = regions.names.Find(name, path, problems);
  if (!index) return;
  const Region& region = regions.regions[*index];
  if (region.elements.empty() && !region.nodes.empty()) {
    problems.Add(path, "region `" + name + "` holds no element",
                 "select by plane, box or sphere, which take those with their centroid inside, by side with a depth, "
                 "or by a tag of tetrahedra or voxels");
  }
  for (const std::int32_t t : region.elements) parts[static_cast<std::size_t>(t)] = value;
}

void TranslateMaterialParts(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                            const TranslatedRegions& regions, const AssetReader& assets, Body& result,
                            Problems& problems) {
  if (body.region_materials().empty() && !body.has_element_parameters()) return;
  Problems own;
  std::vector<Material> materials;
  std::vector<std::int32_t> parts(mesh != nullptr ? mesh->elements() : 0);
  for (int i = 0; i < body.region_materials_size(); ++i) {
    const v1::RegionMaterial& part = body.region_materials(i);
    const std::string path = JoinPath(body_path, IndexPath("region_materials", static_cast<std::size_t>(i)));
    materials.push_back(TranslateMaterial(part.has_material() ? &part.material() : nullptr, path, own));
    MarkRegion(part.region(), JoinPath(path, "region"), regions, i + 1, parts, own);
  }
  if (body.has_element_parameters()) {
    const auto elements =
        TranslateElementParameters(body, JoinPath(body_path, "element_parameters"), mesh, assets, own);
    // Those that a region covers are needed by nobody.
    for (std::size_t t = 0; t < elements.size(); ++t) {
      if (parts[t] != 0) continue;
      materials.push_back(elements[t]);
      parts[t] = static_cast<std::int32_t>(materials.size());
    }
  }
  problems.Append("", own);
  if (!own.empty() || mesh == nullptr) return;
  result.more_materials = std::move(materials);
  result.material_of = std::move(parts);
}

}  // namespace fascicle::server
