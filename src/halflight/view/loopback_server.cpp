#include "halflight/view/loopback_server.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <random>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

// The layout of the library's types depends on what Debian built it with.
#define CPPHTTPLIB_OPENSSL_SUPPORT
#define CPPHTTPLIB_ZLIB_SUPPORT
#define CPPHTTPLIB_BROTLI_SUPPORT
#include <fmt/format.h>
#include <httplib.h>

#include "halflight/base/threads.h"

namespace halflight {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kLoopback = "127.0.0.1";
constexpr int kMostRequests = 1000;      // of one connection
constexpr int kPollMilliseconds = 100;   // between looks at whether the server stops
constexpr double kLongestReply = 120.0;  // seconds; streams of events end by themselves
constexpr int kSpareThreads = 3;         // besides one for each connection: who listens, sharpens

// Nothing but what the page brings along may run in it or be asked by it.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' blob: data:; font-src data:; connect-src 'self'; base-uri 'none'; form-action "
    "'none'; "
    "frame-ancestors 'none'";

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What one thread has to know of the connection that it serves.
thread_local bool t_refuse = false;  // there are too many
thread_local bool t_close = false;   // after this reply: what follows may be an unread body

// A socket with an end to everything: bytes and seconds of a request, seconds of a stalled reply.
class BoundedStream final : public httplib::Stream {
 public:
  BoundedStream(int socket, const WebLimits& limits, const std::atomic<bool>& stopping)
      : socket_(socket), limits_(limits), stopping_(stopping) {}

  // For a request's first byte.
  bool wait_for_request() {
    begin_ = Clock::now();
    bytes_ = 0;
    replied_ = false;
    if (!wait(POLLIN, limits_.idle_seconds)) return false;
    begin_ = Clock::now();
    return true;
  }

  bool is_readable() const override { return ready(POLLIN); }
  bool is_writable() const override {
    if (stopping_) return false;
    // Whoever waits for events sends nothing more: what can be read then is the end.
    char byte = 0;
    const ssize_t n = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return n != 0 && !(n < 0 && errno != EAGAIN && errno != EWOULDBLOCK);
  }
  ssize_t read(char* to, size_t size) override {
    if (next_ == filled_ && !fill()) return -1;
    const std::size_t n = std::min(size, filled_ - next_);
    std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(next_), n, to);
    next_ += n;
    return static_cast<ssize_t>(n);
  }
  ssize_t write(const char* from, size_t size) override {
    // The library goes on with a reply's body where its head was not taken.
    if (!reader_left_ && !send(from, size)) reader_left_ = true;
    return reader_left_ ? -1 : static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = kLoopback;
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    ip = kLoopback;
    port = 0;
  }
  socket_t socket() const override { return socket_; }
  void go_on_without_end() { endless_ = true; }

 private:
  bool ready(short event) const {
    pollfd what{socket_, event, 0};
    return ::poll(&what, 1, 0) > 0;
  }
  bool wait(short event, double seconds) const {
    for (const auto start = Clock::now(); !stopping_ && seconds_since(start) < seconds;) {
      pollfd what{socket_, event, 0};
      const int n = ::poll(&what, 1, kPollMilliseconds);
      if (n > 0) return (what.revents & (event | POLLHUP)) != 0;
      if (n < 0 && errno != EINTR) return false;
    }
    return false;
  }
  bool fill() {
    const double left = limits_.request_seconds - seconds_since(begin_);
    if (bytes_ >= limits_.request_bytes || left <= 0.0 || !wait(POLLIN, left)) return false;
    const ssize_t n = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (n <= 0) return false;
    next_ = 0;
    filled_ = static_cast<std::size_t>(n);
    bytes_ += filled_;
    return true;
  }
  bool send(const char* from, std::size_t size) {
    if (!std::exchange(replied_, true)) reply_begin_ = Clock::now();
    constexpr std::size_t kPortion = 1 << 16;
    std::size_t sent = 0;
    while (sent < size) {
      if (!endless_ && seconds_since(reply_begin_) > kLongestReply) return false;
      if (!wait(POLLOUT, limits_.stall_seconds)) return false;
      const ssize_t n = ::send(socket_, from + sent, std::min(kPortion, size - sent),
                               MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) continue;
      if (n <= 0) return false;
      sent += static_cast<std::size_t>(n);
    }
    return true;
  }

  int socket_;
  const WebLimits& limits_;
  const std::atomic<bool>& stopping_;
  std::array<char, 4096> buffer_{};
  std::size_t next_ = 0, filled_ = 0, bytes_ = 0;
  bool replied_ = false, endless_ = false, reader_left_ = false;
  Clock::time_point begin_, reply_begin_;
};

thread_local BoundedStream* t_stream = nullptr;

// A thread for each connection that may be open; the others are refused at once.
class ConnectionQueue final : public httplib::TaskQueue {
 public:
  ConnectionQueue(std::size_t most, std::atomic<std::size_t>& open, std::atomic<bool>& stopping)
      : most_(most), open_(open), stopping_(stopping), pool_(most) {}

  void enqueue(std::function<void()> serve) override {
    if (open_ >= most_) {
      t_refuse = true;
      serve();
      t_refuse = false;
      return;
    }
    ++open_;
    pool_.enqueue([this, serve = std::move(serve)] {
      serve();
      --open_;
    });
  }
  // The library calls this once it accepts no more connections, whether it was asked to stop or the
  // system has failed it.
  void shutdown() override {
    stopping_ = true;
    pool_.shutdown();
  }

 private:
  std::size_t most_;
  std::atomic<std::size_t>& open_;
  std::atomic<bool>& stopping_;
  httplib::ThreadPool pool_;
};

// Which bytes differ takes no part in how long it takes.
bool same_secret(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |=
        static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

std::string error_json(const std::string& text) {
  std::string safe;
  for (const char c : text)
    if (c != '"' && c != '\\' && static_cast<unsigned char>(c) >= 0x20) safe += c;
  return fmt::format(R"({{"error":"{}"}})", safe);
}

}  // namespace

struct LoopbackServer::Impl final : private httplib::Server {
  Impl(std::string secret, LoopbackServer::Handler on_request, const WebLimits& wanted)
      : token(std::move(secret)), handler(std::move(on_request)), limits(wanted) {
    new_task_queue = [this] { return new ConnectionQueue(limits.connections, open, stopping); };
    // The library's default lets another process bind the same port beside this one.
    set_socket_options([](int s) {
      const int yes = 1;
      ::setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_payload_max_length(limits.request_bytes);
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      return before_routing(request, response);
    });
    Post(".*", [this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
    });
    set_logger([](const httplib::Request&, const httplib::Response& response) {
      if (response.status >= 400) t_close = true;
    });
    set_exception_handler([](const httplib::Request&, httplib::Response& response,
                             const std::exception_ptr&) { response.status = 500; });
  }

  bool open_port(int wanted) {
    port =
        wanted == 0 ? bind_to_any_port(kLoopback) : (bind_to_port(kLoopback, wanted) ? wanted : -1);
    if (port <= 0) return false;
    thread = std::thread([this] { listen_after_bind(); });
    while (!is_running() && !stopping) std::this_thread::yield();
    return true;
  }

  ~Impl() override {
    stopping = true;
    stop();
    if (thread.joinable()) thread.join();
  }

  // None of what the library would unpack, split or convert on a client's word.
  static void strip(httplib::Request& request) {
    request.ranges.clear();
    for (const char* header :
         {"Accept-Encoding", "Content-Encoding", "Content-Type", "Expect", "Range"})
      request.headers.erase(header);
  }

  bool process_and_close_socket(socket_t socket) override {
    if (t_refuse) {
      constexpr std::string_view kBusy =
          "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 0\r\n\r\n";
      ::send(socket, kBusy.data(), kBusy.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    } else {
      const int yes = 1;
      ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      BoundedStream stream(socket, limits, stopping);
      t_stream = &stream;
      bool closed = false;
      for (int i = 0; i < kMostRequests && !closed && stream.wait_for_request(); ++i) {
        t_close = false;
        if (!process_request(stream, i + 1 == kMostRequests, closed, strip) || t_close) break;
      }
      t_stream = nullptr;
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return true;
  }

  // Who is let in: requests to this very address, from the page itself, that know the token.
  int judge(const httplib::Request& request) const {
    const std::string host = request.get_header_value("Host");
    const std::string here = fmt::format("{}:{}", kLoopback, port);
    const std::string also = fmt::format("localhost:{}", port);
    if (request.get_header_value_count("Host") != 1 || (host != here && host != also)) return 403;
    if (request.has_header("Origin")) {
      const std::string origin = request.get_header_value("Origin");
      if (origin != "http://" + host) return 403;
    }
    if (request.has_header("Sec-Fetch-Site")) {
      const std::string site = request.get_header_value("Sec-Fetch-Site");
      if (site != "same-origin" && site != "none") return 403;
    }
    const std::size_t end = request.path.find('/', 1);
    if (request.path.empty() || request.path[0] != '/' || end == std::string::npos) return 403;
    if (!same_secret(request.path.substr(1, end - 1), token)) return 403;
    if (request.method != "GET" && request.method != "POST") return 405;
    return 200;
  }

  HandlerResponse before_routing(const httplib::Request& request, httplib::Response& response) {
    response.set_header("Cache-Control", "no-store");
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header("Content-Security-Policy", kContentPolicy);
    const int verdict = judge(request);
    if (verdict == 200 && request.method == "POST") return HandlerResponse::Unhandled;
    if (verdict == 200) {
      answer(request, response);
      return HandlerResponse::Handled;
    }
    response.status = verdict;
    response.set_content(error_json(verdict == 405 ? "only GET and POST are known here"
                                                   : "open the address that halflight has printed"),
                         "application/json");
    return HandlerResponse::Handled;
  }

  void answer(const httplib::Request& request, httplib::Response& response) {
    WebRequest asked;
    asked.post = request.method == "POST";
    asked.path = request.path.substr(request.path.find('/', 1) + 1);
    for (const auto& [name, value] : request.params) asked.query[name] = value;
    asked.body = request.body;
    WebReply reply = handler(asked);
    response.status = reply.status;
    if (!reply.download_name.empty())
      response.set_header("Content-Disposition",
                          fmt::format("attachment; filename=\"{}\"", reply.download_name));
    if (reply.events) return send_events(std::move(reply.events), response);
    const auto body = reply.body;
    if (body->empty()) return response.set_content("", reply.type);
    response.set_content_provider(
        body->size(), reply.type,
        [body](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
          return sink.write(body->data() + offset, std::min(length, body->size() - offset));
        });
  }

  void send_events(WebEvents events, httplib::Response& response) {
    if (++event_streams > limits.event_streams) {
      --event_streams;
      response.status = 503;
      response.set_content(error_json("too many pages are open: close one"), "application/json");
      return;
    }
    if (t_stream) t_stream->go_on_without_end();
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, events = std::move(events)](std::size_t, httplib::DataSink& sink) {
          const std::optional<std::string> text = events();
          if (!text || stopping) {
            sink.done();
            return true;
          }
          // A comment now and then finds out that nobody listens any more.
          const std::string& said = text->empty() ? ":\n\n" : *text;
          return sink.write(said.data(), said.size());
        },
        [this](bool) { --event_streams; });
  }

  std::string token;
  LoopbackServer::Handler handler;
  WebLimits limits;
  int port = -1;
  std::atomic<bool> stopping{false};
  std::atomic<std::size_t> open{0}, event_streams{0};
  std::thread thread;
};

WebReply web_text(int status, std::string type, std::string body) {
  WebReply reply;
  reply.status = status;
  reply.type = std::move(type);
  reply.body = std::make_shared<const std::string>(std::move(body));
  return reply;
}

LoopbackServer::LoopbackServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LoopbackServer::~LoopbackServer() = default;

Result<std::unique_ptr<LoopbackServer>> LoopbackServer::start(int port, const std::string& token,
                                                              Handler handler,
                                                              const WebLimits& limits) {
  // The library ends the program where it cannot start all of its threads.
  const int threads = static_cast<int>(limits.connections) + kSpareThreads;
  if (startable_threads(threads) < threads)
    return system_error(fmt::format("the system does not let us start {} threads", threads),
                        kLoopback, "lift its limit on processes or threads");
  auto impl = std::make_unique<Impl>(token, std::move(handler), limits);
  if (!impl->open_port(port))
    return system_error(
        port == 0 ? "no port is free" : fmt::format("port {} cannot be opened", port), kLoopback,
        "choose another one with --port, or leave it out");
  return std::unique_ptr<LoopbackServer>(new LoopbackServer(std::move(impl)));
}

void LoopbackServer::serve(int socket) { impl_->process_and_close_socket(socket); }
int LoopbackServer::port() const { return impl_->port; }
std::string LoopbackServer::url() const {
  return fmt::format("http://{}:{}/{}/", kLoopback, impl_->port, impl_->token);
}
bool LoopbackServer::is_open() const { return !impl_->stopping; }
std::size_t LoopbackServer::open_connections() const { return impl_->open; }

std::string random_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

bool is_token(const std::string& text) {
  const auto known = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return text.size() >= 16 && text.size() <= 64 && std::all_of(text.begin(), text.end(), known);
}

}  // namespace halflight
