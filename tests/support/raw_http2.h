#ifndef FASCICLE_TESTS_SUPPORT_RAW_HTTP2_H_
#define FASCICLE_TESTS_SUPPORT_RAW_HTTP2_H_

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace fascicle::testing {

// A connection that speaks just enough HTTP/2 to do what no gRPC client does. Not thread-safe.
class RawHttp2 {
 public:
  // Connects to "127.0.0.1:PORT" and sends nothing.
  explicit RawHttp2(const std::string& address) {
    socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<in_port_t>(std::stoi(address.substr(address.rfind(':') + 1))));
    if (connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to) != 0) {
      close(socket_);
      throw std::runtime_error("cannot connect to " + address);
    }
    const int on = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  ~RawHttp2() { close(socket_); }
  RawHttp2(const RawHttp2&) = delete;
  RawHttp2& operator=(const RawHttp2&) = delete;

  // False if the other side has closed the connection. Answers are read and forgotten.
  bool Send(const std::string& bytes) {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      pollfd ready = {socket_, POLLIN | POLLOUT, 0};
      if (poll(&ready, 1, 10'000) <= 0) return false;
      if ((ready.revents & POLLIN) != 0 && !Forget()) return false;
      if ((ready.revents & POLLOUT) == 0) continue;
      const ssize_t count = send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count < 0 && errno != EAGAIN) return false;
      if (count > 0) sent += static_cast<std::size_t>(count);
    }
    return true;
  }
  // Whether the other side closes the connection within `timeout`.
  bool AwaitEnd(std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (std::chrono::steady_clock::now() < deadline) {
      pollfd ready = {socket_, POLLIN, 0};
      if (poll(&ready, 1, 20) > 0 && !Forget()) return true;
    }
    return false;
  }

  // What a client sends first.
  static std::string Hello() {
    return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(4, 0, 0, "") + Frame(8, 0, 0, std::string("\x40\0\0\0", 4));
  }
  // A call of "/package.Service/Method" with a serialized message.
  static std::string Call(std::uint32_t stream, const std::string& method, const std::string& message) {
    const std::string headers = "\x83\x86" + Literal(":path", method) + Literal(":authority", "a") +
                                Literal("te", "trailers") + Literal("content-type", "application/grpc");
    return Frame(1, 4, stream, headers) + Frame(0, 1, stream, '\0' + Number(message.size()) + message);
  }
  static std::string Reset(std::uint32_t stream) { return Frame(3, 0, stream, Number(8)); }

 private:
  static std::string Number(std::size_t value) {
    std::string bytes;
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift);
    return bytes;
  }
  static std::string Frame(char type, char flags, std::uint32_t stream, const std::string& payload) {
    return Number(payload.size()).substr(1) + type + flags + Number(stream) + payload;
  }
  // A header without compression; names and values of less than 127 bytes.
  static std::string Literal(const std::string& name, const std::string& value) {
    return '\0' + std::string(1, static_cast<char>(name.size())) + name + static_cast<char>(value.size()) + value;
  }
  bool Forget() {
    std::array<char, 1 << 14> bytes;
    const ssize_t count = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    return count > 0 || (count < 0 && errno == EAGAIN);
  }

  int socket_ = -1;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_RAW_HTTP2_H_
