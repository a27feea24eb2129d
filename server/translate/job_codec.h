#ifndef FASCICLE_SERVER_TRANSLATE_JOB_CODEC_H_
#define FASCICLE_SERVER_TRANSLATE_JOB_CODEC_H_

#include "server/jobs/job_manager.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// Reads assets from a store, which must outlive the reader.
AssetReader ReaderOf(AssetStore& assets);

// Conversions of jobs to bytes: a spec is a serialized v1::Job with scene, threads and inputs; geometry, frames,
// failures and lines of the log are serialized v1::Geometry, v1::Frame, v1::Failure and v1::LogLine. Thread-safe.
//   results  keeps results of long stages, and must outlive the codec; null: all are computed
JobCodec MakeJobCodec(ResultCache* results);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_JOB_CODEC_H_
