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

// A model file as a tree of elements that know their line, with what is wrong in them and what nobody took.
//
// Elements are marked as they are taken; what is left without a mark in the end is told as not taken. Entities and
// other files are never followed. Not thread-safe.
class XmlSource {
 public:
  // `name` is told in front of line numbers. Adds a problem when the bytes are not XML.
  XmlSource(std::string name, std::string_view bytes, Problems& problems);

  // The element that holds all others; empty after a problem.
  pugi::xml_node root() const { return document_.document_element(); }

  // "model.feb:12: Mesh/NodeSet \"fixed\"".
  std::string Where(pugi::xml_node node) const;
  int LineOf(pugi::xml_node node) const;

  // Something wrong; `node` is marked.
  void Fail(pugi::xml_node node, const std::string& message, const std::string& hint = {});
  // Something that is left out or not what it was; `node` and all below it are marked. Keeps the first thousand.
  void Tell(Notice::Kind kind, pugi::xml_node node, std::string message);
  std::size_t failures() const { return problems_.count() - count_before_; }

  // Marks one element, or all below it too.
  void Take(pugi::xml_node node) {
    if (!taken_whole_.contains(node.parent().hash_value())) taken_.insert(node.hash_value());
  }
  void TakeAll(pugi::xml_node node) { taken_whole_.insert(node.hash_value()); }
  // Tells of every element of the model that has no mark.
  void TellOfTheRest();
  std::vector<Notice> notices;

  // The text of an element without comments; marks it.
  std::string Text(pugi::xml_node node);
  // An attribute that must be there and not empty; empty, with a problem, when it is not.
  std::string Required(pugi::xml_node node, const char* attribute);
  // A finite number; 0, with a problem, when it is none.
  double Number(pugi::xml_node node);
  Driven DrivenNumber(pugi::xml_node node);
  // Whether 1 or true; false when the element is not there.
  bool Flag(pugi::xml_node node);
  // N finite numbers parted by commas or white space; nothing, with a problem, when they are not.
  std::optional<Vec3> Vector(pugi::xml_node node);
  std::optional<std::array<double, 2>> Pair(pugi::xml_node node);
  // Whole numbers, as many as there are; the number of them is checked when `count` is positive.
  std::optional<std::vector<std::int64_t>> Integers(pugi::xml_node node, std::size_t count = 0);
  // A whole number in an attribute.
  std::optional<std::int64_t> IntegerAttribute(pugi::xml_node node, const char* attribute);

  // A value that is the same everywhere: refuses those that a map or an expression gives.
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
