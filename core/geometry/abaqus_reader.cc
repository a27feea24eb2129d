// Abaqus input files [Abaqus Analysis User's Guide, "Input syntax rules", "Node definition", "Element definition",
// "Surfaces"]: nodes, elements, and sets of them, which become physical tags. A file may have one part.
#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/stop.h"
#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

constexpr std::size_t kMostMembers = 50'000'000;  // of generated sets, each

enum class AbaqusKind { kTetrahedron, kSolid, kTriangle, kQuad, kOtherSolid, kOther };

struct AbaqusType {
  AbaqusKind kind = AbaqusKind::kOther;
  SolidShape shape = SolidShape::kHexahedron;
  std::size_t nodes = 0;
};

std::string Upper(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper;
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, end - begin + 1);
}

std::string_view Unquoted(std::string_view text) {
  const bool quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

std::vector<std::string_view> Fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(Trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
  return fields;
}

// C3D4, C3D10MH, C3D8R, AC3D6, S4R, STRI3, M3D3, R3D4: the number after the family is that of the nodes.
AbaqusType AbaqusTypeNamed(const std::string& name) {
  constexpr std::string_view kSolids[] = {"C3D", "AC3D", "DC3D"};
  constexpr std::string_view kSurfaces[] = {"STRI", "SFM3D", "M3D", "R3D", "DS", "S"};
  const auto family = [&](const auto& families) -> std::size_t {
    for (const std::string_view f : families) {
      if (name.starts_with(f) && name.size() > f.size() && std::isdigit(static_cast<unsigned char>(name[f.size()])))
        return f.size();
    }
    return 0;
  };
  const auto count_after = [&](std::size_t at) {
    std::size_t count = 0;
    for (; at < name.size() && std::isdigit(static_cast<unsigned char>(name[at])) && count < 1000; ++at) {
      count = 10 * count + static_cast<std::size_t>(name[at] - '0');
    }
    return count;
  };
  if (const std::size_t at = family(kSolids); at > 0) {
    const std::size_t nodes = count_after(at);
    if (nodes == 4 || nodes == 10) return {AbaqusKind::kTetrahedron, {}, nodes};
    if (nodes == 8 || nodes == 20 || nodes == 27) return {AbaqusKind::kSolid, SolidShape::kHexahedron, nodes};
    if (nodes == 6 || nodes == 15) return {AbaqusKind::kSolid, SolidShape::kWedge, nodes};
    if (nodes == 5 || nodes == 13) return {AbaqusKind::kSolid, SolidShape::kPyramid, nodes};
    return {AbaqusKind::kOtherSolid, {}, nodes};
  }
  if (const std::size_t at = family(kSurfaces); at > 0) {
    const std::size_t nodes = count_after(at);
    if (nodes == 3 || nodes == 6) return {AbaqusKind::kTriangle, {}, nodes};
    if (nodes == 4 || nodes == 8) return {AbaqusKind::kQuad, {}, nodes};
  }
  return {};
}

std::span<const SolidSide> AbaqusSides(const AbaqusType& type) {
  static constexpr std::array<SolidSide, 4> kTetrahedronSides = {
      {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}}};
  if (type.kind == AbaqusKind::kTetrahedron) return kTetrahedronSides;
  return SidesOf(type.shape);
}

struct AbaqusElement {
  AbaqusType type;
  std::array<std::int64_t, 8> corners = {};
  std::size_t index = 0;  // in the list of its kind
};

// Numbers, or names of other sets.
struct AbaqusSet {
  std::string name;  // as first written
  std::vector<std::int64_t> numbers;
  std::vector<std::string> sets;  // in capitals
};

// A side of an element, or of the elements of a set.
struct SidePart {
  std::optional<std::int64_t> element;
  std::string set;  // in capitals
  int side = 0;     // from 1; 0: all on the outside of the body
};

struct AbaqusSurface {
  std::string name;
  bool of_nodes = false;
  std::vector<SidePart> parts;
};

struct AbaqusKeyword {
  std::string name;                               // in capitals, without *
  std::map<std::string, std::string> parameters;  // keys in capitals
  std::string Parameter(const std::string& key) const {
    const auto found = parameters.find(key);
    return found == parameters.end() ? std::string() : found->second;
  }
};

class AbaqusReader {
 public:
  AbaqusReader(std::string_view bytes, const std::stop_token& stop, Problems& problems)
      : in_(bytes, problems, '\0', stop), stop_(stop), problems_(problems) {}

  RawMesh Read() {
    while (!failed_ && NextLine()) {
      if (line_.starts_with('*')) {
        ReadKeyword();
      } else {
        ReadData(line_);
      }
    }
    FinishElement();
    number_ = 0;
    if (!failed_ && !any_keyword_) Fail("the file has no keywords such as *NODE", "is it an Abaqus input file?");
    if (!failed_) Tag();
    return std::move(raw_);
  }

 private:
  void Fail(const std::string& message, const std::string& hint = {}) {
    if (!failed_) problems_.Add("", (number_ > 0 ? "line " + std::to_string(number_) + ": " : "") + message, hint);
    failed_ = true;
  }

  // The next line that is neither empty nor a comment.
  bool NextLine() {
    while (!in_.AtEnd()) {
      number_ = in_.line();
      line_ = Trimmed(in_.Line());
      if (!line_.empty() && !line_.starts_with("**")) return true;
    }
    return false;
  }

  void ReadKeyword() {
    FinishElement();
    any_keyword_ = true;
    std::string text(line_);
    while (text.ends_with(',') && !in_.AtEnd()) text += Trimmed(in_.Line());  // continued
    const std::vector<std::string_view> fields = Fields(text);
    keyword_ = {};
    keyword_.name = Upper(fields[0].substr(1));
    for (std::size_t i = 1; i < fields.size(); ++i) {
      const std::size_t equals = fields[i].find('=');
      const std::string value(equals == std::string_view::npos ? std::string_view()
                                                               : Trimmed(fields[i].substr(equals + 1)));
      keyword_.parameters[Upper(Trimmed(fields[i].substr(0, equals)))] = Unquoted(value);
    }
    set_ = nullptr;
    surface_ = nullptr;
    constexpr std::string_view kGenerating[] = {"NGEN", "NFILL", "NCOPY", "ELGEN", "ELCOPY", "SYSTEM"};
    if (std::find(std::begin(kGenerating), std::end(kGenerating), keyword_.name) != std::end(kGenerating) ||
        (keyword_.name == "NODE" && !Upper(keyword_.Parameter("SYSTEM")).empty() &&
         Upper(keyword_.Parameter("SYSTEM")) != "R")) {
      Fail("*" + keyword_.name + " makes or moves nodes and elements, which is not supported",
           "write all nodes and elements in global coordinates");
    } else if (keyword_.name == "NODE") {
      set_ = SetNamed(keyword_.Parameter("NSET"), node_sets_);
    } else if (keyword_.name == "ELEMENT") {
      type_ = AbaqusTypeNamed(Upper(keyword_.Parameter("TYPE")));
      set_ = SetNamed(keyword_.Parameter("ELSET"), element_sets_);
    } else if (keyword_.name == "NSET") {
      set_ = Required(SetNamed(keyword_.Parameter("NSET"), node_sets_), "NSET");
    } else if (keyword_.name == "ELSET") {
      set_ = Required(SetNamed(keyword_.Parameter("ELSET"), element_sets_), "ELSET");
    } else if (keyword_.name == "SURFACE") {
      ReadSurfaceKeyword();
    } else if (keyword_.name == "PART" && ++parts_ > 1) {
      Fail("a second *PART: parts have node numbers of their own", "export one part, or a flat input file");
    } else if (keyword_.name == "INCLUDE") {
      Fail("*INCLUDE refers to another file, which is not supported", "put its content here");
    }
  }

  AbaqusSet* SetNamed(const std::string& name, std::map<std::string, AbaqusSet>& sets) {
    if (name.empty()) return nullptr;
    AbaqusSet& set = sets[Upper(name)];
    if (set.name.empty()) set.name = name;
    return &set;
  }

  AbaqusSet* Required(AbaqusSet* set, const char* parameter) {
    if (set == nullptr) Fail("*" + keyword_.name + " has no parameter " + parameter);
    return set;
  }

  void ReadSurfaceKeyword() {
    const std::string name = keyword_.Parameter("NAME");
    if (name.empty()) return Fail("*SURFACE has no parameter NAME");
    surface_ = &surfaces_[Upper(name)];
    surface_->name = name;
    const std::string type = Upper(keyword_.Parameter("TYPE"));
    surface_->of_nodes = type == "NODE";
    if (type.empty() || type == "ELEMENT" || type == "NODE") return;
    raw_.notes.push_back("the surface " + name + " has the type " + type + " and is left out");
    surfaces_.erase(Upper(name));
    surface_ = nullptr;
  }

  void ReadData(std::string_view line) {
    ThrowIfStopped(stop_);
    if (keyword_.name == "NODE") {
      ReadNode(Fields(line));
    } else if (keyword_.name == "ELEMENT") {
      ReadElementLine(Fields(line));
    } else if (keyword_.name == "NSET" || keyword_.name == "ELSET") {
      ReadMembers(Fields(line));
    } else if (keyword_.name == "SURFACE" && surface_ != nullptr) {
      ReadSide(Fields(line));
    } else if (keyword_.name == "INSTANCE") {
      Fail("the instance is moved or turned, which is not supported", "export the part, or a flat input file");
    }
  }

  std::int64_t Number(std::string_view field, const char* what) {
    std::int64_t number = 0;
    if (!ParseInt(field, number)) Fail(std::string("expected ") + what + " but found " + Quoted(field));
    return number;
  }

  void ReadNode(const std::vector<std::string_view>& fields) {
    if (fields.size() < 4) return Fail("a node has a number and three coordinates", "is the file complete?");
    Vec3 x;
    const std::int64_t number = Number(fields[0], "a node number");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!ParseDouble(fields[axis + 1], x[static_cast<Eigen::Index>(axis)])) {
        return Fail("expected a coordinate but found " + Quoted(fields[axis + 1]));
      }
    }
    raw_.node_numbers.push_back(number);
    raw_.nodes.push_back(x);
    if (set_ != nullptr) set_->numbers.push_back(number);
  }

  // An element of many nodes goes on over several lines.
  void ReadElementLine(const std::vector<std::string_view>& fields) {
    if (type_.nodes == 0 || type_.kind == AbaqusKind::kOtherSolid) {
      // Of unknown length: each line counts as one.
      ++(type_.kind == AbaqusKind::kOtherSolid ? raw_.other_solids : raw_.others);
      return;
    }
    for (const std::string_view field : fields) {
      pending_.push_back(Number(field, pending_.empty() ? "an element number" : "a node number"));
      if (failed_) return;
    }
    if (pending_.size() > type_.nodes) FinishElement();
  }

  void FinishElement() {
    if (pending_.empty() || failed_) return;
    const std::vector<std::int64_t> numbers = std::exchange(pending_, {});
    if (numbers.size() != type_.nodes + 1) {
      return Fail("an element of type " + Quoted(keyword_.Parameter("TYPE")) + " has " + std::to_string(type_.nodes) +
                      " nodes, not " + std::to_string(numbers.size() - 1),
                  "is the file complete?");
    }
    AbaqusElement element;
    element.type = type_;
    std::copy_n(numbers.begin() + 1, std::min<std::size_t>(8, type_.nodes), element.corners.begin());
    AddCell(numbers, element);
    if (!elements_.try_emplace(numbers[0], element).second) {
      return Fail("element " + std::to_string(numbers[0]) + " is given twice", "number the elements uniquely");
    }
    if (set_ != nullptr) set_->numbers.push_back(numbers[0]);
  }

  void AddCell(const std::vector<std::int64_t>& numbers, AbaqusElement& element) {
    const auto& c = element.corners;
    switch (type_.kind) {
      case AbaqusKind::kTetrahedron:
        element.index = raw_.tetrahedra.size();
        raw_.tetrahedra.push_back({c[0], c[1], c[2], c[3]});
        raw_.tetrahedron_tags.push_back(0);
        if (type_.nodes == 10) std::copy_n(numbers.begin() + 5, 6, raw_.middles.emplace_back().begin());
        return;
      case AbaqusKind::kSolid:
        element.index = raw_.solids.size();
        raw_.solids.push_back({type_.shape, c});
        if (type_.shape == SolidShape::kHexahedron && type_.nodes >= 20) {
          std::copy_n(numbers.begin() + 9, 12, raw_.solids.back().middles.emplace().begin());
          raw_.inner_nodes += type_.nodes - 20;
        }
        raw_.solid_tags.push_back(0);
        if (type_.nodes > static_cast<std::size_t>(CornersOf(type_.shape))) ++raw_.curved_solids;
        return;
      case AbaqusKind::kTriangle:
      case AbaqusKind::kQuad:
      case AbaqusKind::kOtherSolid:
      case AbaqusKind::kOther:
        return;  // surface cells are added for each of their sets
    }
  }

  void ReadMembers(const std::vector<std::string_view>& fields) {
    if (set_ == nullptr || fields.empty()) return;
    if (keyword_.parameters.contains("GENERATE")) {
      if (fields.size() < 2) return Fail("a generated set needs a first and a last number");
      const std::int64_t first = Number(fields[0], "a number"), last = Number(fields[1], "a number");
      const std::int64_t step = fields.size() > 2 ? Number(fields[2], "a number") : 1;
      if (failed_) return;
      if (step < 1 || last < first || first < 0) return Fail("a generated set does not ascend");
      const std::uint64_t count = static_cast<std::uint64_t>(last - first) / static_cast<std::uint64_t>(step) + 1;
      if (count + set_->numbers.size() > kMostMembers) return Fail("a generated set has too many numbers");
      // Only those that exist, so that a short line does not take much memory.
      for (std::uint64_t i = 0; i < count && i < raw_.nodes.size() + elements_.size() + 1; ++i) {
        set_->numbers.push_back(first + static_cast<std::int64_t>(i) * step);
      }
      if (count > raw_.nodes.size() + elements_.size() + 1) Fail("a generated set has more numbers than the file");
      return;
    }
    for (const std::string_view field : fields) {
      std::int64_t number = 0;
      if (ParseInt(Local(field), number)) {
        set_->numbers.push_back(number);
      } else {
        set_->sets.push_back(Upper(Local(Unquoted(field))));
      }
    }
  }

  // "Part-1-1.Name" is the name of an instance and that of a set, or a number, within it.
  static std::string_view Local(std::string_view name) {
    const std::size_t point = name.rfind('.');
    return point == std::string_view::npos ? name : name.substr(point + 1);
  }

  void ReadSide(const std::vector<std::string_view>& fields) {
    if (fields.empty()) return;
    SidePart part;
    std::int64_t number = 0;
    if (ParseInt(Local(fields[0]), number)) {
      part.element = number;
    } else {
      part.set = Upper(Local(Unquoted(fields[0])));
    }
    if (fields.size() > 1 && !surface_->of_nodes) {
      const std::string side = Upper(fields[1]);
      if (side == "SPOS" || side == "SNEG") {
        part.side = 1;
      } else if (side.size() == 2 && side[0] == 'S' && side[1] >= '1' && side[1] <= '6') {
        part.side = side[1] - '0';
      } else {
        return Fail("expected a side such as S1 but found " + Quoted(fields[1]));
      }
    }
    surface_->parts.push_back(std::move(part));
  }

  // The numbers of a set and of all sets that it contains, ascending and unique.
  std::vector<std::int64_t> NumbersOf(const std::string& name, const std::map<std::string, AbaqusSet>& sets) {
    std::vector<std::int64_t> numbers;
    std::set<std::string> met = {name};
    std::vector<std::string> open = {name};
    while (!open.empty()) {
      ThrowIfStopped(stop_);
      const std::string next = std::move(open.back());
      open.pop_back();
      const auto found = sets.find(next);
      if (found == sets.end()) {
        Fail("there is no set " + Quoted(next), "is the file complete?");
        return {};
      }
      numbers.insert(numbers.end(), found->second.numbers.begin(), found->second.numbers.end());
      for (const std::string& other : found->second.sets) {
        if (met.insert(other).second) open.push_back(other);
      }
    }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  }

  std::int32_t NewTag(int dimension, const std::string& name) {
    const auto tag = static_cast<std::int32_t>(raw_.names.size() + 1);
    raw_.names.push_back({dimension, tag, name});
    return tag;
  }

  // Makes physical tags of all sets: of elements, then of surfaces, then of nodes.
  void Tag() {
    for (const auto& [name, set] : element_sets_) TagElements(name, set);
    for (const auto& [name, surface] : surfaces_) {
      surface.of_nodes ? TagNodeSurface(surface) : TagSides(surface);
      if (failed_) return;
    }
    for (const auto& [name, set] : node_sets_) TagNodes(set.name, NumbersOf(name, node_sets_));
  }

  void TagElements(const std::string& key, const AbaqusSet& set) {
    const std::vector<std::int64_t> numbers = NumbersOf(key, element_sets_);
    bool any_solid = false, any_surface = false;
    for (const std::int64_t number : numbers) {
      const AbaqusElement* element = Find(number);
      any_solid = any_solid || (element && IsVolume(*element));
      any_surface =
          any_surface ||
          (element && (element->type.kind == AbaqusKind::kTriangle || element->type.kind == AbaqusKind::kQuad));
    }
    if (!any_solid && !any_surface) return;
    const std::int32_t tag = NewTag(any_solid ? 3 : 2, set.name);
    for (const std::int64_t number : numbers) {
      if (const AbaqusElement* element = Find(number)) AddTag(*element, tag);
    }
  }

  const AbaqusElement* Find(std::int64_t number) const {
    const auto found = elements_.find(number);
    return found == elements_.end() ? nullptr : &found->second;
  }

  void AddTag(const AbaqusElement& element, std::int32_t tag) {
    const auto add = [&](std::vector<std::int64_t>& tags, std::vector<std::array<std::int64_t, 2>>& further) {
      std::int64_t& first = tags[element.index];
      if (first == 0) {
        first = tag;
      } else {
        further.push_back({static_cast<std::int64_t>(element.index), tag});
      }
    };
    const auto& c = element.corners;
    switch (element.type.kind) {
      case AbaqusKind::kTetrahedron:
        return add(raw_.tetrahedron_tags, raw_.further_tags);
      case AbaqusKind::kSolid:
        return add(raw_.solid_tags, raw_.further_solid_tags);
      case AbaqusKind::kTriangle:
        raw_.triangles.push_back({c[0], c[1], c[2]});
        raw_.triangle_tags.push_back(tag);
        return;
      case AbaqusKind::kQuad:
        raw_.quads.push_back({c[0], c[1], c[2], c[3]});
        raw_.quad_tags.push_back(tag);
        return;
      case AbaqusKind::kOtherSolid:
      case AbaqusKind::kOther:
        return;
    }
  }

  void AddSide(const AbaqusElement& element, std::size_t side, std::int32_t tag) {
    const auto& local = AbaqusSides(element.type)[side];
    const auto at = [&](int k) {
      return element.corners[static_cast<std::size_t>(local[static_cast<std::size_t>(k)])];
    };
    if (local[3] < 0) {
      raw_.triangles.push_back({at(0), at(1), at(2)});
      raw_.triangle_tags.push_back(tag);
    } else {
      raw_.quads.push_back({at(0), at(1), at(2), at(3)});
      raw_.quad_tags.push_back(tag);
    }
  }

  void TagSides(const AbaqusSurface& surface) {
    const std::int32_t tag = NewTag(2, surface.name);
    for (const SidePart& part : surface.parts) {
      const std::vector<std::int64_t> numbers =
          part.element ? std::vector<std::int64_t>{*part.element} : NumbersOf(part.set, element_sets_);
      if (part.side == 0) {
        TagOuterSides(numbers, tag);
        continue;
      }
      for (const std::int64_t number : numbers) {
        const AbaqusElement* element = Find(number);
        if (element == nullptr) return Fail("there is no element " + std::to_string(number), "is the file complete?");
        if (element->type.kind == AbaqusKind::kTriangle || element->type.kind == AbaqusKind::kQuad) {
          AddTag(*element, tag);
          continue;
        }
        if (!IsVolume(*element)) continue;
        if (static_cast<std::size_t>(part.side) > AbaqusSides(element->type).size()) {
          return Fail("element " + std::to_string(number) + " has no side S" + std::to_string(part.side));
        }
        AddSide(*element, static_cast<std::size_t>(part.side) - 1, tag);
      }
    }
  }

  // Without a side: the elements' sides on the outside of the body.
  void TagOuterSides(const std::vector<std::int64_t>& numbers, std::int32_t tag) {
    if (side_counts_.empty()) {
      for (const auto& [number, element] : elements_) {
        ThrowIfStopped(stop_);
        for (std::size_t s = 0; IsVolume(element) && s < AbaqusSides(element.type).size(); ++s) {
          ++side_counts_[KeyOf(element, s)];
        }
      }
    }
    for (const std::int64_t number : numbers) {
      const AbaqusElement* element = Find(number);
      if (element != nullptr && !IsVolume(*element)) AddTag(*element, tag);
      for (std::size_t s = 0; element && IsVolume(*element) && s < AbaqusSides(element->type).size(); ++s) {
        if (side_counts_.at(KeyOf(*element, s)) == 1) AddSide(*element, s, tag);
      }
    }
  }

  static bool IsVolume(const AbaqusElement& element) {
    return element.type.kind == AbaqusKind::kTetrahedron || element.type.kind == AbaqusKind::kSolid;
  }

  using SideKey = std::array<std::int64_t, 4>;
  static SideKey KeyOf(const AbaqusElement& element, std::size_t side) {
    SideKey key = {-1, -1, -1, -1};
    for (std::size_t k = 0; k < 4; ++k) {
      const int local = AbaqusSides(element.type)[side][k];
      if (local >= 0) key[k] = element.corners[static_cast<std::size_t>(local)];
    }
    std::sort(key.begin(), key.end());
    return key;
  }

  void TagNodeSurface(const AbaqusSurface& surface) {
    std::vector<std::int64_t> numbers;
    for (const SidePart& part : surface.parts) {
      const std::vector<std::int64_t> more =
          part.element ? std::vector<std::int64_t>{*part.element} : NumbersOf(part.set, node_sets_);
      numbers.insert(numbers.end(), more.begin(), more.end());
    }
    TagNodes(surface.name, numbers);
  }

  void TagNodes(const std::string& name, const std::vector<std::int64_t>& numbers) {
    if (numbers.empty()) return;
    const std::int32_t tag = NewTag(0, name);
    for (const std::int64_t number : numbers) {
      raw_.points.push_back({number});
      raw_.point_tags.push_back(tag);
    }
  }

  TextScanner in_;
  const std::stop_token& stop_;
  Problems& problems_;
  bool failed_ = false;
  std::string_view line_;
  int number_ = 0;  // of the line; 0 after the last one
  bool any_keyword_ = false;
  int parts_ = 0;
  AbaqusKeyword keyword_;
  AbaqusType type_;
  std::vector<std::int64_t> pending_;  // numbers of an element
  AbaqusSet* set_ = nullptr;           // to which the next nodes, elements or numbers belong
  AbaqusSurface* surface_ = nullptr;
  std::map<std::string, AbaqusSet> node_sets_, element_sets_;  // by their names in capitals
  std::map<std::string, AbaqusSurface> surfaces_;
  std::unordered_map<std::int64_t, AbaqusElement> elements_;
  std::map<SideKey, int> side_counts_;  // of all volume elements
  RawMesh raw_;
};

}  // namespace

RawMesh ReadAbaqus(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  return AbaqusReader(bytes, stop, problems).Read();
}

}  // namespace fascicle
