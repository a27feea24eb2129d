#include "client/lib/transfer.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "client/lib/replace_file.h"
#include "client/lib/status_error.h"
#include "core/base/digest.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::hours kLongest(24);

Error Unreadable(const std::string& path) {
  return {Error::Kind::kInvalid, "can't read " + path + ": there is no such file, or no permission", "", {}};
}

// Appends all chunks to `out`; DATA_LOSS if one does not follow the others.
grpc::Status ReadChunks(Connection& connection, const v1::ExportJobRequest& request, grpc::ClientContext& context,
                        std::ofstream& out) {
  const auto reader = connection.transfers().ExportJob(&context, request);
  v1::ExportJobResponse message;
  std::int64_t received = 0;
  bool is_complete = false;
  while (reader->Read(&message)) {
    const v1::Chunk& chunk = message.chunk();
    if (chunk.offset() != received || Crc32c(chunk.data()) != chunk.crc32c()) {
      context.TryCancel();
      return {grpc::StatusCode::DATA_LOSS, "the file was damaged in transit"};
    }
    out << chunk.data();
    received += static_cast<std::int64_t>(chunk.data().size());
    is_complete = chunk.last();
  }
  grpc::Status status = reader->Finish();
  if (status.ok() && !is_complete) return {grpc::StatusCode::UNAVAILABLE, "the export was interrupted"};
  return status;
}

// The server may respond before it has read everything, if it refuses the file.
grpc::Status SendFile(Connection& connection, std::ifstream& file, v1::ImportJobRequest request,
                      grpc::ClientContext& context, v1::Job& job) {
  constexpr std::size_t kChunk = 1 << 20;
  const auto writer = connection.transfers().ImportJob(&context, &job);
  std::int64_t left = request.size();
  bool open = true;
  while (open && left > 0) {
    std::string& data = *request.mutable_data();
    data.resize(std::min(kChunk, static_cast<std::size_t>(left)));
    if (!file.read(data.data(), static_cast<std::streamsize>(data.size()))) {
      context.TryCancel();
      break;
    }
    left -= static_cast<std::int64_t>(data.size());
    open = writer->Write(request);
    request.Clear();
  }
  if (open && left == 0) writer->WritesDone();
  return writer->Finish();
}

}  // namespace

std::optional<Error> DownloadJob(Connection& connection, const std::string& name, const std::string& path,
                                 const std::stop_token& stop) {
  v1::ExportJobRequest request;
  request.set_name(name);
  grpc::Status status;
  const auto download = [&](const fs::path& beside) {
    const auto once = [&](grpc::ClientContext& context) {
      std::ofstream out(beside, std::ios::binary | std::ios::trunc);
      grpc::Status read = ReadChunks(connection, request, context, out);
      out.close();
      if (!out) throw std::runtime_error("can't write " + path + ": no permission, or no space left");
      return read;
    };
    status = connection.Repeat(kLongest, once, stop);
    if (!status.ok()) throw std::runtime_error("not exported");  // leaves no file
  };
  try {
    ReplaceFile(path, download);
  } catch (const std::runtime_error& error) {
    if (status.ok()) return Error{Error::Kind::kInternal, error.what(), "", {}};
    if (stop.stop_requested()) return Error{Error::Kind::kStopped, "stopped before the job was exported", "", {}};
    return ErrorOf(status, connection.address());
  }
  return std::nullopt;
}

Result<v1::Job> UploadJob(Connection& connection, const std::string& path, bool new_name, const std::string& request_id,
                          const std::stop_token& stop) {
  std::error_code error;
  const auto size = static_cast<std::int64_t>(fs::file_size(path, error));
  if (error || !fs::is_regular_file(path)) return Unreadable(path);
  v1::ImportJobRequest request;
  request.set_size(size);
  request.set_request_id(request_id);
  request.set_new_name(new_name);
  v1::Job job;
  bool is_readable = true;
  const auto send = [&](grpc::ClientContext& context) {
    std::ifstream file(path, std::ios::binary);
    is_readable = file.is_open();
    if (!is_readable) return grpc::Status::CANCELLED;
    return SendFile(connection, file, request, context, job);
  };
  const grpc::Status status = connection.Repeat(kLongest, send, stop);
  if (!is_readable) return Unreadable(path);
  if (stop.stop_requested() && !status.ok()) {
    return Error{Error::Kind::kStopped, "stopped before the job was imported", "", {}};
  }
  if (!status.ok()) return ErrorOf(status, connection.address());
  return job;
}

}  // namespace fascicle::client
