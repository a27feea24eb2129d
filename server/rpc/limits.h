#ifndef FASCICLE_SERVER_RPC_LIMITS_H_
#define FASCICLE_SERVER_RPC_LIMITS_H_

#include <chrono>

namespace fascicle::server {

// The most calls of a kind at once.
struct CallLimit {
  int in_all;
  int of_connection;
};

// What clients may use at once. Further calls are refused with UNAVAILABLE and RetryInfo.
struct Limits {
  int connections = 1000;             // fewer if the process may not open twice as many files
  CallLimit streams = {2000, 256};    // frames, geometry, logs, exports, WatchJobs
  CallLimit uploads = {64, 16};       // UploadAsset, ImportJob
  CallLimit submissions = {96, 48};   // CreateJob, VerifyJob
  CallLimit calls = {1000, 128};      // all others
  CallLimit kept_calls = {1000, 64};  // GetJob, ListJobs, CancelJob: they have threads and connections of their own
  std::chrono::milliseconds idle_upload = std::chrono::seconds(60);        // without a message; it ends then
  std::chrono::milliseconds silent_connection = std::chrono::seconds(30);  // without any call yet; it ends then
  std::chrono::milliseconds longest_check = std::chrono::minutes(10);      // of a CreateJob or VerifyJob
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_LIMITS_H_
