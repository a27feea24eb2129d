#include "core/base/archive.h"

#include <bit>
#include <cstring>
#include <utility>

#include "core/base/check.h"
#include "core/base/digest.h"

namespace fascicle {
namespace {

static_assert(std::endian::native == std::endian::little, "archives store values in little-endian memory order");
static_assert(sizeof(Vec3) == 3 * sizeof(double));

constexpr std::string_view kMagic = "FSCA";
constexpr std::size_t kMaxName = 255;

enum Type : char { kInt = 'i', kDouble = 'd', kString = 's', kInts = 'I', kDoubles = 'D', kVectors = 'V' };

}  // namespace

ArchiveWriter::ArchiveWriter(std::string_view kind, std::uint32_t version) : bytes_(kMagic) {
  PutHead('k', kind);
  PutRaw(&version, sizeof(version));
}

void ArchiveWriter::PutHead(char type, std::string_view name) {
  FASCICLE_CHECK(name.size() <= kMaxName, "archive name too long");
  bytes_ += type;
  bytes_ += static_cast<char>(name.size());
  bytes_ += name;
}

void ArchiveWriter::PutInt(std::string_view name, std::int64_t value) {
  PutHead(kInt, name);
  PutRaw(&value, sizeof(value));
}

void ArchiveWriter::PutDouble(std::string_view name, double value) {
  PutHead(kDouble, name);
  PutRaw(&value, sizeof(value));
}

void ArchiveWriter::PutString(std::string_view name, std::string_view value) {
  PutHead(kString, name);
  const std::uint64_t count = value.size();
  PutRaw(&count, sizeof(count));
  bytes_ += value;
}

void ArchiveWriter::PutInts(std::string_view name, std::span<const std::int32_t> values) {
  PutHead(kInts, name);
  const std::uint64_t count = values.size();
  PutRaw(&count, sizeof(count));
  PutRaw(values.data(), values.size_bytes());
}

void ArchiveWriter::PutDoubles(std::string_view name, std::span<const double> values) {
  PutHead(kDoubles, name);
  const std::uint64_t count = values.size();
  PutRaw(&count, sizeof(count));
  PutRaw(values.data(), values.size_bytes());
}

void ArchiveWriter::PutVectors(std::string_view name, std::span<const Vec3> values) {
  PutHead(kVectors, name);
  const std::uint64_t count = values.size();
  PutRaw(&count, sizeof(count));
  PutRaw(values.data(), values.size_bytes());
}

std::string ArchiveWriter::Finish() {
  const std::uint32_t crc = Crc32c(bytes_);
  PutRaw(&crc, sizeof(crc));
  return std::move(bytes_);
}

ArchiveReader::ArchiveReader(std::string_view bytes, std::string_view kind, std::uint32_t version) : rest_(bytes) {
  std::uint32_t crc = 0;
  if (bytes.size() < kMagic.size() + sizeof(crc) || !bytes.starts_with(kMagic)) {
    failed_ = true;
    return;
  }
  rest_.remove_suffix(sizeof(crc));
  std::memcpy(&crc, bytes.data() + rest_.size(), sizeof(crc));
  failed_ = Crc32c(rest_) != crc;
  rest_.remove_prefix(kMagic.size());
  std::uint32_t version_there = 0;
  if (TakeHead('k', kind) && TakeRaw(&version_there, sizeof(version_there)) && version_there != version) failed_ = true;
}

bool ArchiveReader::TakeRaw(void* data, std::size_t size) {
  if (failed_ || rest_.size() < size) {
    failed_ = true;
    return false;
  }
  std::memcpy(data, rest_.data(), size);
  rest_.remove_prefix(size);
  return true;
}

bool ArchiveReader::TakeHead(char type, std::string_view name) {
  char type_there = 0, length = 0;
  if (!TakeRaw(&type_there, 1) || !TakeRaw(&length, 1)) return false;
  const std::size_t size = static_cast<unsigned char>(length);
  if (type_there != type || rest_.size() < size || rest_.substr(0, size) != name) {
    failed_ = true;
    return false;
  }
  rest_.remove_prefix(size);
  return true;
}

std::int64_t ArchiveReader::GetInt(std::string_view name) {
  std::int64_t value = 0;
  if (TakeHead(kInt, name)) TakeRaw(&value, sizeof(value));
  return value;
}

double ArchiveReader::GetDouble(std::string_view name) {
  double value = 0;
  if (TakeHead(kDouble, name)) TakeRaw(&value, sizeof(value));
  return value;
}

std::string ArchiveReader::GetString(std::string_view name) { return std::string(TakeArray(kString, name, 1)); }

std::string_view ArchiveReader::TakeArray(char type, std::string_view name, std::size_t item_size) {
  std::uint64_t count = 0;
  if (!TakeHead(type, name) || !TakeRaw(&count, sizeof(count))) return {};
  if (count > rest_.size() / item_size) {
    failed_ = true;
    return {};
  }
  const std::string_view bytes = rest_.substr(0, count * item_size);
  rest_.remove_prefix(bytes.size());
  return bytes;
}

template <class Item>
void ArchiveReader::GetVector(char type, std::string_view name, std::vector<Item>& values) {
  const std::string_view bytes = TakeArray(type, name, sizeof(Item));
  if (failed_) return;
  values.resize(bytes.size() / sizeof(Item));
  if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
}

template <class Item>
void ArchiveReader::GetSpan(char type, std::string_view name, std::span<Item> values) {
  const std::string_view bytes = TakeArray(type, name, sizeof(Item));
  if (!failed_ && bytes.size() != values.size_bytes()) failed_ = true;
  if (failed_ || bytes.empty()) return;
  std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
}

void ArchiveReader::GetInts(std::string_view name, std::vector<std::int32_t>& values) {
  GetVector(kInts, name, values);
}
void ArchiveReader::GetDoubles(std::string_view name, std::vector<double>& values) {
  GetVector(kDoubles, name, values);
}
void ArchiveReader::GetVectors(std::string_view name, std::vector<Vec3>& values) { GetVector(kVectors, name, values); }
void ArchiveReader::GetInts(std::string_view name, std::span<std::int32_t> values) { GetSpan(kInts, name, values); }
void ArchiveReader::GetDoubles(std::string_view name, std::span<double> values) { GetSpan(kDoubles, name, values); }
void ArchiveReader::GetVectors(std::string_view name, std::span<Vec3> values) { GetSpan(kVectors, name, values); }

}  // namespace fascicle
