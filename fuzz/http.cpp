// All that a client sends to the live view's web server, up to the questions to the solver. The
// scene could not be read, so that no light is found meanwhile. "@HOST@" stands for the server's
// address, which is another each time.
#include <thread>

#include <sys/socket.h>
#include <unistd.h>

#include "fuzz_target.h"
#include "halflight/view/view_routes.h"

namespace halflight::fuzz {
namespace {

constexpr const char* kToken = "0123456789abcdef";

class Server {
 public:
  Server() {
    while (!session_.failure()) std::this_thread::yield();
    page_[""] = {"text/html", "<!doctype html>"};
    page_["view.js"] = {"text/javascript", "0"};
    auto routes = view_routes(session_, page_);
    const auto handler = [routes = std::move(routes)](const WebRequest& request) {
      WebReply reply = routes(request);
      if (reply.events) reply.events = [] { return std::nullopt; };  // nothing will happen
      return reply;
    };
    WebLimits limits;
    limits.stall_seconds = 0.02;  // replies are read only once all are there
    auto server = LoopbackServer::start(0, kToken, handler, limits);
    require(server.has_value(), "there is a port");
    server_ = std::move(*server);
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(server_->port()); }

  // What comes back when so much is sent.
  std::string answer(const std::string& sent) {
    int ends[2];
    require(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0, "there is a socket");
    require(::send(ends[0], sent.data(), sent.size(), MSG_NOSIGNAL) ==
                static_cast<ssize_t>(sent.size()),
            "it takes what is sent");
    ::shutdown(ends[0], SHUT_WR);
    server_->serve(ends[1]);
    std::string all(1 << 16, '\0');
    const ssize_t n = ::recv(ends[0], all.data(), all.size(), 0);
    ::close(ends[0]);
    all.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return all;
  }

 private:
  ViewSession session_{[]() -> Result<Scene> { return input_error("no scene", "here"); }, {}};
  PageFiles page_;
  std::unique_ptr<LoopbackServer> server_;
};

}  // namespace
}  // namespace halflight::fuzz

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace halflight;
  static fuzz::Server server;
  constexpr std::string_view kHost = "@HOST@";
  std::string text(fuzz::text_of(data, std::min<std::size_t>(size, 64 << 10)));
  // A percent sign may spell the token.
  const bool knows_token =
      text.find(fuzz::kToken) != std::string::npos || text.find('%') != std::string::npos;
  for (std::size_t at = 0; (at = text.find(kHost, at)) != std::string::npos;)
    text.replace(at, kHost.size(), server.host());
  const std::string reply = server.answer(text);
  fuzz::require(reply.empty() || reply.starts_with("HTTP/1.1 "), "replies are HTTP");
  fuzz::require(knows_token || !reply.starts_with("HTTP/1.1 200"), "strangers get nothing");
  return 0;
}
