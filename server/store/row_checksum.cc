#include "server/store/row_checksum.h"

#include <sqlite3.h>

#include <cstdint>
#include <string_view>

#include "core/base/digest.h"
#include "server/store/store.h"

namespace fascicle::server {
namespace {

template <class Number>
std::uint32_t AddNumber(Number number, std::uint32_t crc) {
  return Crc32c({reinterpret_cast<const char*>(&number), sizeof number}, crc);
}

std::uint32_t AddValue(sqlite3_value* value, std::uint32_t crc) {
  const int type = sqlite3_value_type(value);
  crc = AddNumber(type, crc);
  if (type == SQLITE_NULL) return crc;
  if (type == SQLITE_INTEGER) return AddNumber(sqlite3_value_int64(value), crc);
  if (type == SQLITE_FLOAT) return AddNumber(sqlite3_value_double(value), crc);
  const auto* bytes = static_cast<const char*>(sqlite3_value_blob(value));
  const auto size = static_cast<std::size_t>(sqlite3_value_bytes(value));
  crc = AddNumber(static_cast<std::int64_t>(size), crc);  // so that no byte can move to the next value
  return size == 0 ? crc : Crc32c({bytes, size}, crc);
}

void RowChecksum(sqlite3_context* context, int count, sqlite3_value** values) {
  std::uint32_t crc = 0;
  for (int i = 0; i < count; ++i) crc = AddValue(values[i], crc);
  sqlite3_result_int64(context, crc);
}

}  // namespace

void AddRowChecksum(sqlite3* connection) {
  constexpr int kFlags = SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS;
  const int code = sqlite3_create_function_v2(connection, "row_checksum", -1, kFlags, nullptr, &RowChecksum, nullptr,
                                              nullptr, nullptr);
  if (code != SQLITE_OK) throw StoreError(std::string("row_checksum: ") + sqlite3_errstr(code));
}

}  // namespace fascicle::server
