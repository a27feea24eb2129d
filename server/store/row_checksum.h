#ifndef FASCICLE_SERVER_STORE_ROW_CHECKSUM_H_
#define FASCICLE_SERVER_STORE_ROW_CHECKSUM_H_

struct sqlite3;

namespace fascicle::server {

// Adds the SQL function row_checksum(value, ...) to a connection: the CRC-32C of the types and bytes of its arguments.
// Every table stores it in its column `checksum`, over all other columns, keys included: neither a changed value nor a
// value at the place of another passes unnoticed. Throws StoreError.
void AddRowChecksum(sqlite3* connection);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_ROW_CHECKSUM_H_
