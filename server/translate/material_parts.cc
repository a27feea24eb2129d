#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/text_lines.h"
#include "server/translate/files.h"
#include "server/translate/materials.h"
#include "server/translate/number_files.h"
#include "server/translate/parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

// Indices of the law's parameters named by the first line of a file; nothing if the line is invalid.
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
      own.Add({}, "the first line: `" + std::string(word.substr(0, 64)) + "` is not a parameter of " + law.name,
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

// A material for each element, from a file whose first line names the parameters given by the others.
std::vector<Material> ReadMaterials(std::string_view text, const v1::Material& wire, std::size_t elements,
                                    Problems& problems) {
  const LawInfo& law = *LawOf(wire);
  std::vector<double> values = ParametersOf(wire);
  Problems of_law;  // reported with the body's material
  const auto make = MakerOf(wire, {}, of_law);
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
    if (problems.empty() && count < elements) materials.push_back(make(values));
  }
  CheckLineCount(count, elements, "elements", problems);
  return materials;
}

std::vector<Material> TranslateElementParameters(const BodySource& source, std::optional<std::size_t> elements,
                                                 Problems& problems) {
  const v1::Body& wire = source.wire;
  const std::string path = JoinPath(source.path, "element_parameters");
  const auto bytes = ReadFile(wire.element_parameters(), path, source.assets, problems);
  const LawInfo* law = LawOf(wire.material());
  if (!bytes || !elements || law == nullptr || !ObeysRules(wire.material())) return {};
  Problems own;
  std::vector<Material> materials = ReadMaterials(*bytes, wire.material(), *elements, own);
  problems.Append(path, own);
  return own.empty() ? materials : std::vector<Material>();
}

}  // namespace

void MarkRegion(const std::string& name, const std::string& path, const NamedRegions& regions, std::int32_t value,
                std::vector<std::int32_t>& parts, Problems& problems) {
  const auto index = regions.names.Find(name, path, problems);
  if (!index) return;
  const Region& region = regions.regions[*index];
  if (region.elements.empty() && !region.nodes.empty()) {
    problems.Add(path, "region `" + name + "` contains no element",
                 "select by plane, box or sphere, which take those with their centroid inside, by side with a depth, "
                 "or by a tag of tetrahedra or voxels");
  }
  for (const std::int32_t t : region.elements) parts[static_cast<std::size_t>(t)] = value;
}

Parts<Material> TranslateMaterialParts(const BodySource& source, std::optional<std::size_t> elements,
                                       const NamedRegions& regions, Problems& problems) {
  const v1::Body& wire = source.wire;
  if (wire.region_materials().empty() && !wire.has_element_parameters()) return {};
  Problems own;
  Parts<Material> parts;
  parts.of.resize(elements.value_or(0));
  for (int i = 0; i < wire.region_materials_size(); ++i) {
    const v1::RegionMaterial& part = wire.region_materials(i);
    const std::string path = JoinPath(source.path, IndexPath("region_materials", static_cast<std::size_t>(i)));
    parts.more.push_back(TranslateMaterial(part.has_material() ? &part.material() : nullptr, path, own));
    MarkRegion(part.region(), JoinPath(path, "region"), regions, i + 1, parts.of, own);
  }
  if (wire.has_element_parameters()) {
    const auto of_elements = TranslateElementParameters(source, elements, own);
    // Removes materials that no element uses because regions cover them.
    for (std::size_t t = 0; t < of_elements.size(); ++t) {
      if (parts.of[t] != 0) continue;
      parts.more.push_back(of_elements[t]);
      parts.of[t] = static_cast<std::int32_t>(parts.more.size());
    }
  }
  problems.Append("", own);
  if (!own.empty() || !elements) return {};
  return parts;
}

std::vector<PronySeries> TranslatePartViscoelasticity(const BodySource& source, std::size_t parts, Problems& problems) {
  const v1::Body& wire = source.wire;
  std::vector<PronySeries> series;
  for (int i = 0; i < wire.region_materials_size(); ++i) {
    const std::string path = JoinPath(source.path, IndexPath("region_materials", static_cast<std::size_t>(i)));
    const v1::Material& material = wire.region_materials(i).material();
    series.push_back(TranslateViscoelasticity(material, JoinPath(path, "material"), problems));
  }
  if (series.size() > parts) return {};  // a problem has been reported
  // Elements with their own parameters have the series of the body, whose law they share.
  Problems of_body;  // reported with the body's material
  series.resize(parts, TranslateViscoelasticity(wire.material(), {}, of_body));
  const auto is_elastic = [](const PronySeries& s) { return s.terms.empty(); };
  if (std::all_of(series.begin(), series.end(), is_elastic)) return {};
  return series;
}

}  // namespace fascicle::server
