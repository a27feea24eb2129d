#include "core/sim/fingerprint.h"

#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

namespace fascicle {
namespace {

// Hashes a value and all that it holds. What may be of any length or kind begins with it, so that no two different
// scenes give the same bytes.
class Fingerprint {
 public:
  template <HasFields Struct>
  void Put(const Struct& s) {
    VisitFields(s, [this](const char*, const auto& member) { this->Put(member); });
  }

  template <class Value>
  requires kIsFlat<Value>
  void Put(const Value& value) { PutBytes(value); }

  // A kind without members.
  template <class Value>
  requires std::is_empty_v<Value>
  void Put(const Value&) {}

  void Put(const std::string& text) {
    PutBytes(text.size());
    sha_.Update(text);
  }

  template <class Value>
  void Put(const std::optional<Value>& value) {
    PutBytes(value.has_value());
    if (value) Put(*value);
  }

  template <class Value>
  void Put(const std::vector<Value>& list) {
    PutBytes(list.size());
    if constexpr (kIsFlat<Value>) {
      sha_.Update(std::as_bytes(std::span(list)));
    } else {
      for (const Value& value : list) Put(value);
    }
  }

  template <class Value, std::size_t kCount>
  requires(!kIsFlat<Value>) void Put(const std::array<Value, kCount>& list) {
    for (const Value& value : list) Put(value);
  }

  template <class... Kinds>
  void Put(const std::variant<Kinds...>& value) {
    PutBytes(value.index());
    std::visit([this](const auto& kind) { this->Put(kind); }, value);
  }

  // A law holds nothing but numbers, which follow from its parameters, or refers to some.
  template <class Law>
  requires requires { Law::kNeedsFibres; }
  void Put(const Law& law) {
    if constexpr (requires { law.curves(); }) {
      PutNumbers(law.numbers());
      PutNumbers(law.curves());
    } else {
      PutNumbers(law);
    }
  }

  Digest Finish() { return sha_.Finish(); }

 private:
  template <class Numbers>
  void PutNumbers(const Numbers& numbers) {
    static_assert(std::is_trivially_copyable_v<Numbers> && sizeof(Numbers) % sizeof(double) == 0);
    PutBytes(numbers);
  }
  template <class Value>
  void PutBytes(const Value& value) {
    sha_.Update(std::as_bytes(std::span(&value, 1)));
  }

  Sha256 sha_;
};

}  // namespace

Digest FingerprintOf(const Scene& scene) {
  Fingerprint fingerprint;
  fingerprint.Put(scene);
  return fingerprint.Finish();
}

}  // namespace fascicle
