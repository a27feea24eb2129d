#ifndef FASCICLE_CLIENT_IMPORT_XML_SOURCE_H_
#define FASCICLE_CLIENT_IMPORT_XML_SOURCE_H_

#include <array>
#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "client/import/febio_import.h"
#include "core/base/problems.h"
#include "core/base/types.h"

namespace fascicle::client {

// A number that a load controller may scale.
struct Driven {
  double value = 0;
  std::optional<std::int64_t> controller;
  pugi::xml_node node;
};

// A model file as a tree of elements that know their line, with the problems found in them and a record of the elements
// that were read.
//
// Elements are marked when they are read; unmarked ones are finally reported as not supported. Entities and other files
// are never followed. Not thread-safe.
class XmlSource {
 public:
  // `name` precedes line numbers in messages. Adds a problem if the bytes are not XML.
  XmlSource(std::string name, std::string_view bytes, Problems& problems);

  // The root element; empty after a problem.
  pugi::xml_node root() const { return document_.document_element(); }

  // "model.feb:12: Mesh/NodeSet \"fixed\"".
  std::string Where(pugi::xml_node node) const;
  int LineOf(pugi::xml_node node) const;

  // Reports a problem and marks `node`.
  void Fail(pugi::xml_node node, const std::string& message, const std::string& hint = {});
  // Reports something that is missing, changed or assumed. Keeps the first thousand.
  void Remark(Notice::Kind kind, pugi::xml_node node, std::string message, std::string hint = {});
  // The same; marks `node` and its descendants.
  void Tell(Notice::Kind kind, pugi::xml_node node, std::string message, std::string hint = {});
  std::size_t failures() const { return problems_.count() - count_before_; }

  // Marks one element, or all of its descendants, too.
  void Take(pugi::xml_node node) {
    if (!taken_whole_.contains(node.parent().hash_value())) taken_.insert(node.hash_value());
  }
  void TakeAll(pugi::xml_node node) { taken_whole_.insert(node.hash_value()); }
  // Reports every unmarked element of the model, but empty sections.
  void TellOfTheRest();
  std::vector<Notice> notices;

  // The text of an element without comments; marks it.
  std::string Text(pugi::xml_node node);
  // Words separated by commas or white space, of an element, or of a text.
  std::vector<std::string> Words(pugi::xml_node node) { return WordsOf(Text(node)); }
  static std::vector<std::string> WordsOf(std::string_view text);
  // A required, non-empty attribute; empty, with a problem, if it is missing.
  std::string Required(pugi::xml_node node, const char* attribute);
  // A finite number, or an expression of numbers if type is "math"; 0, with a problem, otherwise.
  double Number(pugi::xml_node node);
  // The expression of an element, which may be within <math>.
  std::string MathText(pugi::xml_node node);
  Driven DrivenNumber(pugi::xml_node node);
  // Whether the text is 1 or true; false if the element does not exist.
  bool Flag(pugi::xml_node node);
  // N finite numbers separated by commas or white space; nothing, with a problem, otherwise.
  std::optional<Vec3> Vector(pugi::xml_node node);
  std::optional<std::array<double, 2>> Pair(pugi::xml_node node);
  // Integers, any number of them; checked against `count` if it is positive.
  std::optional<std::vector<std::int64_t>> Integers(pugi::xml_node node, std::size_t count = 0);
  // An integer attribute.
  std::optional<std::int64_t> IntegerAttribute(pugi::xml_node node, const char* attribute);

  // Whether a value is the same everywhere: a number, or an expression (`Number` takes both). Refuses maps.
  bool IsConstant(pugi::xml_node node);

 private:
  bool Numbers(pugi::xml_node node, double* values, std::size_t count);
  std::string PathOf(pugi::xml_node node) const;
  void TellOfChildren(pugi::xml_node parent, int depth);

  std::string name_;
  Problems& problems_;
  std::size_t count_before_;
  std::string buffer_;
  std::vector<std::size_t> line_ends_;
  pugi::xml_document document_;
  std::unordered_set<std::size_t> taken_, taken_whole_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_XML_SOURCE_H_
