// A web server for one user on this machine: bound to 127.0.0.1, every address behind a random
// token, everything that a client can make it hold or wait for bounded. It knows nothing of light.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "halflight/base/result.h"

namespace halflight {

struct WebRequest {
  bool post = false;
  std::string path;  // behind the token: "" for the page, "api/light"
  std::map<std::string, std::string> query;
  std::string body;
};

// Text that goes on. Each call waits up to a second for more; empty: nothing new; none: the end.
using WebEvents = std::function<std::optional<std::string>()>;

struct WebReply {
  int status = 200;
  std::string type = "application/json";
  std::shared_ptr<const std::string> body = std::make_shared<const std::string>();
  std::string download_name;  // of a file that the browser is to save; empty: to be shown
  WebEvents events;           // instead of a body
};

WebReply web_text(int status, std::string type, std::string body);

struct WebLimits {
  std::size_t connections = 24;  // more are told so and closed
  std::size_t event_streams = 8;
  std::size_t request_bytes = 96 << 10;  // head and body together
  double request_seconds = 10.0;         // from the first byte to the last
  double idle_seconds = 20.0;            // between requests of a connection
  double stall_seconds = 5.0;            // a reader who takes nothing for so long is left
};

class LoopbackServer {
 public:
  using Handler = std::function<WebReply(const WebRequest&)>;

  // Port 0: any that is free. The handler is called from many threads at once.
  static Result<std::unique_ptr<LoopbackServer>> start(int port, const std::string& token,
                                                       Handler handler,
                                                       const WebLimits& limits = {});
  // Ends all connections.
  ~LoopbackServer();
  LoopbackServer(const LoopbackServer&) = delete;
  LoopbackServer& operator=(const LoopbackServer&) = delete;

  // Answers what comes over a connected socket until that ends, on this thread, and closes it.
  void serve(int socket);

  int port() const;
  std::string url() const;  // with the token
  bool is_open() const;     // false: the system lets it accept no more connections, all are closed
  std::size_t open_connections() const;

 private:
  struct Impl;
  explicit LoopbackServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// 128 random bits in hexadecimal digits.
std::string random_token();

// Letters, digits, - and _ only, 16 to 64 of them.
bool is_token(const std::string& text);

}  // namespace halflight
