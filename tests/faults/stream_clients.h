#ifndef FASCICLE_TESTS_FAULTS_STREAM_CLIENTS_H_
#define FASCICLE_TESTS_FAULTS_STREAM_CLIENTS_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <grpcpp/generic/generic_stub.h>

#include "tests/support/service_fixture.h"

namespace fascicle::service_test {

// Health as any client asks for it.
inline std::function<bool()> HealthCall(const std::string& address) {
  const auto stubs = std::make_shared<Stubs>(address);
  return [stubs] {
    grpc::GenericStub stub(stubs->channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 20s);
    grpc::CompletionQueue queue;
    const grpc::Slice nothing("");
    const grpc::ByteBuffer request(&nothing, 1);
    auto call = stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", request, &queue);
    call->StartCall();
    grpc::ByteBuffer response;
    grpc::Status status;
    call->Finish(&response, &status, &response);
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && status.ok();
  };
}

inline std::function<bool()> GetJobCall(const std::string& address, const std::string& name) {
  const auto stubs = std::make_shared<Stubs>(address);
  return [stubs, name] { return stubs->Get(name).name() == name; };
}

// Readers of StreamFrames, each with its own connection. They read as fast as they can, again from the start when the
// stream has ended, or stop reading after the header.
class StreamClients {
 public:
  StreamClients(const std::string& address, const v1::StreamFramesRequest& request, int count, bool stalled = false)
      : request_(request), stalled_(stalled) {
    for (int i = 0; i < count; ++i) readers_.push_back(std::make_unique<Reader>(*this, address));
    for (auto& reader : readers_) reader->Start();
  }
  ~StreamClients() {
    stop_ = true;
    for (auto& reader : readers_) reader->Cancel();
    while (running_ > 0) std::this_thread::sleep_for(1ms);
  }

  std::int64_t bytes() const { return bytes_; }
  std::int64_t messages() const { return messages_; }
  int failures() const { return failures_; }

 private:
  // On gRPC's own threads: a thread for each reader would be what is measured.
  class Reader : public grpc::ClientReadReactor<v1::StreamFramesResponse> {
   public:
    Reader(StreamClients& all, const std::string& address) : all_(all), stubs_(address) {}

    void Start() {
      const std::lock_guard lock(mutex_);
      if (all_.stop_) return;
      ++all_.running_;
      context_ = std::make_unique<grpc::ClientContext>();
      stubs_.frames->async()->StreamFrames(context_.get(), &all_.request_, this);
      StartRead(&message_);
      StartCall();
    }
    void Cancel() {
      const std::lock_guard lock(mutex_);
      if (context_) context_->TryCancel();
    }
    void OnReadDone(bool ok) override {
      if (!ok) return;
      all_.bytes_ += static_cast<std::int64_t>(message_.chunk().data().size());
      ++all_.messages_;
      if (!all_.stalled_) StartRead(&message_);
    }
    void OnDone(const grpc::Status& status) override {
      if (!status.ok() && !all_.stop_) ++all_.failures_;
      const bool again = status.ok() && !all_.stop_;
      if (again) Start();
      --all_.running_;
    }

   private:
    StreamClients& all_;
    Stubs stubs_;
    std::mutex mutex_;
    std::unique_ptr<grpc::ClientContext> context_;
    v1::StreamFramesResponse message_;
  };

  const v1::StreamFramesRequest request_;
  const bool stalled_;
  std::atomic<std::int64_t> bytes_ = 0, messages_ = 0;
  std::atomic<int> failures_ = 0, running_ = 0;
  std::atomic<bool> stop_ = false;
  std::vector<std::unique_ptr<Reader>> readers_;
};

}  // namespace fascicle::service_test

#endif  // FASCICLE_TESTS_FAULTS_STREAM_CLIENTS_H_
