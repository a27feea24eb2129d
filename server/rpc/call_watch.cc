#include "server/rpc/call_watch.h"

#include <algorithm>
#include <string>

#include <google/protobuf/descriptor.h>

#include "server/rpc/errors.h"

namespace fascicle::server {
namespace {

// Whether a service of this program has the method "/package.Service/Method".
bool IsKnown(const std::string& method) {
  std::string name = method.substr(std::min<std::size_t>(method.size(), 1));
  std::replace(name.begin(), name.end(), '/', '.');
  return google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(name) != nullptr;
}

// gRPC's reflection is served by threads of its own, where IsCancelled would call the interceptors again, without end.
bool HasThread(const std::string& method) { return method.starts_with("/grpc.reflection."); }

class CallWatch : public grpc::experimental::Interceptor {
 public:
  CallWatch(Connections& connections, grpc::experimental::ServerRpcInfo& info)
      : connections_(connections),
        info_(info),
        method_(info.method()),
        connection_(connections.BeginCall(info.server_context()->peer())) {}
  ~CallWatch() override { connections_.EndCall(connection_); }

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(grpc::experimental::InterceptionHookPoints::PRE_SEND_STATUS)) {
      Explain(*methods);
    }
    if (methods->QueryInterceptionHookPoint(grpc::experimental::InterceptionHookPoints::POST_RECV_CLOSE) &&
        !HasThread(method_) && info_.server_context()->IsCancelled()) {
      connections_.NoteReset(connection_);
    }
    methods->Proceed();
  }

 private:
  // gRPC refuses what it cannot parse, and methods that do not exist, with a bare UNIMPLEMENTED.
  void Explain(grpc::experimental::InterceptorBatchMethods& methods) const {
    const grpc::Status status = methods.GetSendStatus();
    if (status.error_code() != grpc::StatusCode::UNIMPLEMENTED || !status.error_details().empty()) return;
    methods.ModifySendStatus(IsKnown(method_) ? NotAMessage() : UnknownMethod(method_));
  }

  Connections& connections_;
  grpc::experimental::ServerRpcInfo& info_;
  const std::string method_;
  const Connections::Handle connection_;
};

class CallWatchFactory : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit CallWatchFactory(Connections& connections) : connections_(connections) {}
  grpc::experimental::Interceptor* CreateServerInterceptor(grpc::experimental::ServerRpcInfo* info) override {
    return new CallWatch(connections_, *info);
  }

 private:
  Connections& connections_;
};

}  // namespace

std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> WatchCalls(
    Connections& connections) {
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> factories;
  factories.push_back(std::make_unique<CallWatchFactory>(connections));
  return factories;
}

}  // namespace fascicle::server
