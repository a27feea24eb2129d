#ifndef FASCICLE_CLIENT_EXPORT_CSV_H_
#define FASCICLE_CLIENT_EXPORT_CSV_H_

#include <filesystem>
#include <string>
#include <vector>

#include "client/lib/series_table.h"

namespace fascicle::client {

// Comma-separated text by RFC 4180 with a header: `frame,time [s],step,NAME [UNIT],...`. Numbers read back as the same
// number; NaN is an empty field.
std::string CsvOf(const SeriesTable& table);

// The same for any columns of equal length; a header entry is `NAME [UNIT]`.
struct CsvColumn {
  std::string heading;
  std::vector<double> values;
};
std::string CsvOf(const std::vector<CsvColumn>& columns);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_CSV_H_
