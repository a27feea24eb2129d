#include "core/scene/curves.h"

#include <algorithm>
#include <cstdint>

namespace fascicle {
namespace {

// The path of a value in the scene. It is made into text only on demand, since there may be a million values.
struct Place {
  const Place* parent = nullptr;
  const char* name = "";
  std::int64_t index = -1;  // in a list; negative: a member with this name

  std::string Path() const {
    const std::string of_parent = parent == nullptr ? "" : parent->Path();
    return index < 0 ? JoinPath(of_parent, name) : IndexPath(of_parent, static_cast<std::size_t>(index));
  }
};

class CurveVisitor {
 public:
  explicit CurveVisitor(const std::function<void(const Curve&, const std::string&)>& visit) : visit_(visit) {}

  void Take(const Curve& curve, const Place& place) const { visit_(curve, place.Path()); }

  template <HasFields Struct>
  void Take(const Struct& s, const Place& place) const {
    VisitFields(s, [&](const char* name, const auto& member) { Take(member, {&place, name}); });
  }

  template <class Value>
  void Take(const std::optional<Value>& value, const Place& place) const {
    if (value) Take(*value, place);
  }

  template <class... Kinds>
  void Take(const std::variant<Kinds...>& value, const Place& place) const {
    std::visit([&](const auto& kind) { Take(kind, place); }, value);
  }

  template <class Value>
  void Take(const std::vector<Value>& list, const Place& place) const {
    TakeList(list, place);
  }

  template <class Value, std::size_t kCount>
  void Take(const std::array<Value, kCount>& list, const Place& place) const {
    TakeList(list, place);
  }

  // Other types contain no curves.
  template <class Value>
  void Take(const Value&, const Place&) const {}

 private:
  template <class List>
  void TakeList(const List& list, const Place& place) const {
    if (kIsFlat<typename List::value_type>) return;
    std::int64_t k = 0;
    for (const auto& value : list) Take(value, {&place, "", k++});
  }

  const std::function<void(const Curve&, const std::string&)>& visit_;
};

}  // namespace

void VisitCurves(const Scene& scene, const std::function<void(const Curve&, const std::string&)>& visit) {
  CurveVisitor(visit).Take(scene, {});
}

}  // namespace fascicle
