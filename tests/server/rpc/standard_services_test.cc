// Health and reflection, as load balancers and grpcurl use them. Debian ships no headers for either: health is called
// with bytes written by hand, reflection with the messages that the library registers.
#include <memory>
#include <set>
#include <string>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpcpp/generic/generic_stub.h>

#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using StandardServicesTest = ServiceTest;

grpc::Status CallOnce(Stubs& stubs, const std::string& method, const std::string& request, std::string& response) {
  grpc::GenericStub stub(stubs.channel);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + 10s);
  const grpc::Slice slice(request);
  grpc::ByteBuffer in(&slice, 1), out;
  grpc::CompletionQueue queue;
  const auto call = stub.PrepareUnaryCall(&context, method, in, &queue);
  call->StartCall();
  grpc::Status status;
  call->Finish(&out, &status, &status);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  if (status.ok()) {
    grpc::Slice whole;
    if (out.DumpToSingleSlice(&whole).ok()) response.assign(reinterpret_cast<const char*>(whole.begin()), whole.size());
  }
  return status;
}

// HealthCheckRequest{service = 1}; HealthCheckResponse{status = 1}: 1 is SERVING.
TEST_F(StandardServicesTest, HealthOfEachServiceAndOfAll) {
  for (const std::string service : {"", "fascicle.v1.JobService", "fascicle.v1.AssetService",
                                    "fascicle.v1.FrameService", "fascicle.v1.ServerService"}) {
    const std::string request =
        service.empty() ? "" : std::string("\x0a") + static_cast<char>(service.size()) + service;
    std::string response;
    ASSERT_TRUE(CallOnce(*stubs_, "/grpc.health.v1.Health/Check", request, response).ok()) << service;
    EXPECT_EQ(response, std::string("\x08\x01")) << service;
  }
  std::string response;
  EXPECT_EQ(CallOnce(*stubs_, "/grpc.health.v1.Health/Check", std::string("\x0a\x04none"), response).error_code(),
            grpc::StatusCode::NOT_FOUND);
}

TEST_F(StandardServicesTest, ReflectionListsTheServices) {
  using google::protobuf::Message;
  const auto* pool = google::protobuf::DescriptorPool::generated_pool();
  const auto make = [&](const char* type) -> std::unique_ptr<Message> {
    const auto* descriptor = pool->FindMessageTypeByName(type);
    if (descriptor == nullptr) return nullptr;
    return std::unique_ptr<Message>(
        google::protobuf::MessageFactory::generated_factory()->GetPrototype(descriptor)->New());
  };
  const auto request = make("grpc.reflection.v1alpha.ServerReflectionRequest");
  const auto response = make("grpc.reflection.v1alpha.ServerReflectionResponse");
  ASSERT_TRUE(request && response);
  request->GetReflection()->SetString(request.get(), request->GetDescriptor()->FindFieldByName("list_services"), "*");

  grpc::GenericStub stub(stubs_->channel);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + 10s);
  grpc::CompletionQueue queue;
  const auto call =
      stub.PrepareCall(&context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
  const auto await = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  call->StartCall(nullptr);
  ASSERT_TRUE(await());
  const grpc::Slice slice(request->SerializeAsString());
  call->Write(grpc::ByteBuffer(&slice, 1), nullptr);
  ASSERT_TRUE(await());
  grpc::ByteBuffer answer;
  call->Read(&answer, nullptr);
  ASSERT_TRUE(await());
  grpc::Slice whole;
  ASSERT_TRUE(answer.DumpToSingleSlice(&whole).ok());
  ASSERT_TRUE(response->ParseFromArray(whole.begin(), static_cast<int>(whole.size())));
  const std::string text = response->ShortDebugString();
  for (const char* service :
       {"fascicle.v1.JobService", "fascicle.v1.AssetService", "fascicle.v1.FrameService", "fascicle.v1.ServerService",
        "fascicle.v1.SteeringService", "fascicle.v1.LogService", "grpc.health.v1.Health"}) {
    EXPECT_NE(text.find(std::string("\"") + service + "\""), std::string::npos) << text;
  }
  call->WritesDone(nullptr);
  await();
  grpc::Status status;
  call->Finish(&status, nullptr);
  await();
  EXPECT_TRUE(status.ok());
}

}  // namespace
}  // namespace fascicle::service_test
