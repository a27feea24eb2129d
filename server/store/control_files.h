#ifndef FASCICLE_SERVER_STORE_CONTROL_FILES_H_
#define FASCICLE_SERVER_STORE_CONTROL_FILES_H_

#include <string>

#include "server/store/database.h"

namespace fascicle::server {

// control.db and its copy, control.copy.db. Every change is written to both in one transaction, but only control.db is
// synced: the copy is there for damage to the disk's content, not for a loss of power.
struct ControlFiles {
  std::string main;
  std::string copy;
};

// Opens control.db with its copy attached as `copy`. If one of them is damaged it is set aside as *.damaged-{n} and
// made again from the other; if both are, from all rows that can still be read. Rows that differ otherwise are taken
// from control.db. Throws StoreError if a file can't be opened for another reason, such as a newer format.
Database OpenControl(const ControlFiles& files);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_CONTROL_FILES_H_
