#ifndef FASCICLE_CORE_BASE_ARCHIVE_H_
#define FASCICLE_CORE_BASE_ARCHIVE_H_

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

// Writes named values to bytes from which an ArchiveReader restores the same bits. Checkpoints are archives.
// Layout, little-endian: "FSCA", kind, version, fields, CRC-32C of everything before it. A field is its type, name and
// value.
// Not thread-safe.
class ArchiveWriter {
 public:
  // `kind` names the contents (at most 255 bytes); `version` numbers the layout of the fields.
  ArchiveWriter(std::string_view kind, std::uint32_t version);

  // Names have at most 255 bytes.
  void PutInt(std::string_view name, std::int64_t value);
  void PutDouble(std::string_view name, double value);
  void PutString(std::string_view name, std::string_view value);
  void PutInts(std::string_view name, std::span<const std::int32_t> values);
  void PutDoubles(std::string_view name, std::span<const double> values);
  void PutVectors(std::string_view name, std::span<const Vec3> values);

  // Ends the archive. Nothing may be put after it.
  std::string Finish();

 private:
  void PutHead(char type, std::string_view name);
  void PutRaw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  std::string bytes_;
};

// Reads an archive in the order in which it was written. Any mismatch (damaged or missing bytes, another kind, version,
// name, type or length) sets failed() for good; later reads give zero or leave the value unchanged.
// Never reads beyond the bytes and never allocates more than they hold. Not thread-safe.
class ArchiveReader {
 public:
  // `bytes` must outlive the reader.
  ArchiveReader(std::string_view bytes, std::string_view kind, std::uint32_t version);

  std::int64_t GetInt(std::string_view name);
  double GetDouble(std::string_view name);
  std::string GetString(std::string_view name);
  // Any length.
  void GetInts(std::string_view name, std::vector<std::int32_t>& values);
  void GetDoubles(std::string_view name, std::vector<double>& values);
  void GetVectors(std::string_view name, std::vector<Vec3>& values);
  // Exactly values.size() numbers.
  void GetInts(std::string_view name, std::span<std::int32_t> values);
  void GetDoubles(std::string_view name, std::span<double> values);
  void GetVectors(std::string_view name, std::span<Vec3> values);

  // Marks the archive as failed for a reason that the reader cannot detect by itself.
  void Fail() { failed_ = true; }
  bool failed() const { return failed_; }
  // Whether every read succeeded and no bytes are left.
  bool AtEnd() const { return !failed_ && rest_.empty(); }

 private:
  bool TakeHead(char type, std::string_view name);
  bool TakeRaw(void* data, std::size_t size);
  // Reads the head and length of an array. Returns its bytes, or nothing on failure.
  std::string_view TakeArray(char type, std::string_view name, std::size_t item_size);
  template <class Item>
  void GetVector(char type, std::string_view name, std::vector<Item>& values);
  template <class Item>
  void GetSpan(char type, std::string_view name, std::span<Item> values);

  std::string_view rest_;
  bool failed_ = false;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_ARCHIVE_H_
