#ifndef FASCICLE_TESTS_FAULTS_LOSSY_DISK_H_
#define FASCICLE_TESTS_FAULTS_LOSSY_DISK_H_

#include <cstdint>
#include <string>

namespace fascicle::server {

// A disk that may lose what was not synced, for all of SQLite's files of this process.
enum class Syncs { kHonoured, kIgnored };

// Makes every database that is opened from now on write to it. Once per process.
void UseLossyDisk(Syncs syncs);

// The power fails: copies `directory` to `after` as a disk may hold it then. Of the writes since the last sync of each
// file some are lost, some kept and some torn between sectors, by the seed. No write returns after this call.
void CutPower(const std::string& directory, const std::string& after, std::uint64_t seed);

}  // namespace fascicle::server

#endif  // FASCICLE_TESTS_FAULTS_LOSSY_DISK_H_
