// The live view's web server against clients that mean no good: every one is refused in bounded
// time and space, and the page goes on being served.
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "halflight/view/loopback_server.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Clock = std::chrono::steady_clock;

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A client that sends what it likes.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~RawClient() { ::close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool connected() const { return connected_; }
  bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }
  // What comes until the end, or until nothing comes for so long.
  std::string receive(double seconds) const {
    std::string all;
    char chunk[4096];
    for (const auto start = Clock::now(); seconds_since(start) < seconds;) {
      pollfd what{socket_, POLLIN, 0};
      if (::poll(&what, 1, 50) <= 0) continue;
      const ssize_t n = ::recv(socket_, chunk, sizeof chunk, 0);
      if (n <= 0) break;
      all.append(chunk, static_cast<std::size_t>(n));
    }
    return all;
  }
  // Seconds until the server hangs up, or `at_most`.
  double seconds_to_end(double at_most) const {
    const auto start = Clock::now();
    receive(at_most);
    return seconds_since(start);
  }

 private:
  int socket_;
  bool connected_ = false;
};

class ViewServer : public ::testing::Test {
 protected:
  ViewServer() {
    WebLimits limits;
    limits.connections = 6;
    limits.event_streams = 2;
    limits.request_bytes = 16 << 10;
    limits.request_seconds = 1.0;
    limits.idle_seconds = 1.0;
    limits.stall_seconds = 0.5;
    auto started = LoopbackServer::start(
        0, kToken,
        [this](const WebRequest& request) {
          const std::lock_guard lock(mutex_);
          requests_.push_back(request);
          if (request.path == "large")
            return web_text(200, "text/plain", std::string(1 << 25, 'x'));
          if (request.path == "events") {
            WebReply reply;
            reply.events = []() -> std::optional<std::string> {
              std::this_thread::sleep_for(std::chrono::milliseconds(50));
              return std::string();
            };
            return reply;
          }
          return web_text(request.path == "page" ? 200 : 404, "text/plain", "hello");
        },
        limits);
    server_ = std::move(*started);
  }

  std::string host() const { return fmt::format("127.0.0.1:{}", server_->port()); }
  std::string get(const std::string& path, const std::string& headers = "") const {
    return fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n{}\r\n", path, host(),
                       headers);
  }
  std::string inside(const std::string& path) const { return fmt::format("/{}/{}", kToken, path); }
  std::string answer_to(const std::string& request, double seconds = 3.0) const {
    const RawClient client(server_->port());
    client.send(request);
    return client.receive(seconds);
  }
  void expect_page() const {
    EXPECT_THAT(answer_to(get(inside("page"))), StartsWith("HTTP/1.1 200"));
  }
  std::size_t handled() {
    const std::lock_guard lock(mutex_);
    return requests_.size();
  }

  std::mutex mutex_;
  std::vector<WebRequest> requests_;
  std::unique_ptr<LoopbackServer> server_;
};

TEST_F(ViewServer, ServesThePageToWhoKnowsTheToken) {
  const std::string answer = answer_to(get(inside("page")));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("hello"));
  EXPECT_THAT(answer, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_THAT(answer, HasSubstr("Referrer-Policy: no-referrer"));
}

TEST_F(ViewServer, RefusesOtherTokensPathsAndMethods) {
  for (const char* path :
       {"/", "/page", "/x/page", "/0123456789abcdef0123456789abcdeF/page",
        "/0123456789abcdef0123456789abcde/page", "//0123456789abcdef0123456789abcdef/page",
        "/../0123456789abcdef0123456789abcdef/page", "/%00/page"})
    EXPECT_THAT(answer_to(get(path)), StartsWith("HTTP/1.1 403")) << path;
  EXPECT_EQ(handled(), 0u);
  for (const char* method : {"PUT", "DELETE", "PATCH", "OPTIONS", "HEAD"}) {
    const std::string request = fmt::format(
        "{} {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", method, inside("page"), host());
    EXPECT_THAT(answer_to(request), StartsWith("HTTP/1.1 405")) << method;
  }
  EXPECT_EQ(handled(), 0u);
  expect_page();
}

TEST_F(ViewServer, TakesNoPathOfAFile) {
  for (const char* path : {"../../etc/passwd", "..%2f..%2fetc%2fpasswd", "/etc/passwd",
                           "%2e%2e/%2e%2e/etc/passwd", "page/../../etc/passwd", "page%00.txt"}) {
    const std::string answer = answer_to(get(inside(path)));
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 404")) << path;
    EXPECT_THAT(answer, Not(HasSubstr("root:"))) << path;
  }
  expect_page();
}

TEST_F(ViewServer, RefusesOtherOriginsAndHosts) {
  for (const std::string& headers :
       {std::string("Origin: http://example.com\r\n"), std::string("Origin: null\r\n"),
        fmt::format("Origin: https://{}\r\n", host()), std::string("Origin: http://127.0.0.1\r\n"),
        std::string("Sec-Fetch-Site: cross-site\r\n"), std::string("Sec-Fetch-Site: same-site\r\n"),
        std::string("Host: example.com\r\n")})
    EXPECT_THAT(answer_to(get(inside("page"), headers)), StartsWith("HTTP/1.1 403")) << headers;
  // A name that somebody else made point here.
  const std::string rebound =
      fmt::format("GET {} HTTP/1.1\r\nHost: evil.example:{}\r\nConnection: close\r\n\r\n",
                  inside("page"), server_->port());
  EXPECT_THAT(answer_to(rebound), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(
      answer_to(fmt::format("GET {} HTTP/1.1\r\nConnection: close\r\n\r\n", inside("page"))),
      StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(handled(), 0u);
  EXPECT_THAT(answer_to(get(inside("page"), fmt::format("Origin: http://{}\r\n", host()))),
              StartsWith("HTTP/1.1 200"));
}

TEST_F(ViewServer, RefusesGiantRequests) {
  const std::string post = fmt::format("POST {} HTTP/1.1\r\nHost: {}\r\n", inside("page"), host());
  EXPECT_THAT(answer_to(post + "Content-Length: 99999999999\r\n\r\nx"), Not(HasSubstr("200 OK")));
  EXPECT_THAT(answer_to(post + "Content-Length: 18446744073709551617\r\n\r\nx"),
              Not(HasSubstr("200 OK")));
  EXPECT_THAT(answer_to(post + "Content-Length: -1\r\n\r\nx"), Not(HasSubstr("200 OK")));
  EXPECT_THAT(answer_to(post + "Transfer-Encoding: chunked\r\n\r\nffffffff\r\nxxxx"),
              Not(HasSubstr("200 OK")));
  EXPECT_THAT(answer_to(get("/" + std::string(100'000, 'a'))), Not(HasSubstr("200 OK")));
  std::string many = get(inside("page"));
  many.resize(many.size() - 2);
  for (int i = 0; i < 20'000; ++i) many += fmt::format("X-{}: y\r\n", i);
  EXPECT_THAT(answer_to(many + "\r\n"), Not(HasSubstr("200 OK")));
  EXPECT_EQ(handled(), 0u);
  expect_page();
}

TEST_F(ViewServer, UnpacksAndSplitsNothingOnAClientsWord) {
  std::string ranges = "Range: bytes=0-0";
  for (int i = 0; i < 1500; ++i) ranges += ",0-0";
  const std::string answer = answer_to(get(inside("page"), ranges + "\r\n"));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 ")) << "the server must outlive this";
  expect_page();
  const std::string body = "not really packed";
  answer_to(
      fmt::format("POST {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n"
                  "Content-Encoding: gzip\r\nContent-Type: multipart/form-data; boundary=x\r\n"
                  "Content-Length: {}\r\n\r\n{}",
                  inside("page"), host(), body.size(), body));
  const std::lock_guard lock(mutex_);
  EXPECT_EQ(requests_.back().body, body);
}

TEST_F(ViewServer, LeavesClientsThatDawdle) {
  const RawClient silent(server_->port()), halfway(server_->port()), dripping(server_->port());
  halfway.send("GET / HT");
  const auto start = Clock::now();
  std::thread drip([&] {
    for (int i = 0; i < 40 && dripping.send("x"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
  });
  EXPECT_LT(silent.seconds_to_end(4.0), 3.0);
  EXPECT_LT(halfway.seconds_to_end(4.0), 3.0);
  EXPECT_LT(dripping.seconds_to_end(4.0), 3.0);
  drip.join();
  EXPECT_LT(seconds_since(start), 8.0);
  expect_page();
}

TEST_F(ViewServer, LeavesReadersThatTakeNothing) {
  const RawClient slow(server_->port());
  slow.send(get(inside("large")));
  const auto start = Clock::now();
  while (server_->open_connections() == 0 && seconds_since(start) < 2.0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  while (server_->open_connections() > 0 && seconds_since(start) < 5.0)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_LT(seconds_since(start), 4.0);
  EXPECT_LT(slow.receive(2.0).size(), std::size_t{1} << 25);
  expect_page();
}

// Small replies, so many that the next one finds no room: neither its head nor its body.
TEST(ViewServerReplies, AreWaitedForOnceWhereNobodyTakesThem) {
  WebLimits limits;
  limits.stall_seconds = 2.0;
  const auto server = LoopbackServer::start(
      0, kToken, [](const WebRequest&) { return web_text(200, "text/plain", "hello"); }, limits);
  ASSERT_TRUE(server);
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  std::string requests;
  for (int i = 0; i < 400; ++i)
    requests += fmt::format("GET /{}/page HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", kToken,
                            (*server)->port());
  ASSERT_EQ(::send(ends[0], requests.data(), requests.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(requests.size()));
  ::shutdown(ends[0], SHUT_WR);
  const auto start = Clock::now();
  (*server)->serve(ends[1]);
  EXPECT_GT(seconds_since(start), 1.9);
  EXPECT_LT(seconds_since(start), 3.8);
  ::close(ends[0]);
}

TEST_F(ViewServer, TurnsAwayMoreConnectionsThanItHolds) {
  std::vector<std::unique_ptr<RawClient>> crowd;
  for (int i = 0; i < 30; ++i) crowd.push_back(std::make_unique<RawClient>(server_->port()));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_LE(server_->open_connections(), 6u);
  std::size_t refused = 0;
  for (std::size_t i = 6; i < crowd.size(); ++i)
    refused += crowd[i]->receive(0.3).find("503") != std::string::npos ? 1 : 0;
  EXPECT_GE(refused, 1u);  // others have waited until the first were left for being idle
  crowd.clear();
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  expect_page();
}

TEST_F(ViewServer, BoundsEventStreamsAndNoticesWhenTheyLeave) {
  auto first = std::make_unique<RawClient>(server_->port());
  const RawClient second(server_->port());
  first->send(get(inside("events")));
  second.send(get(inside("events")));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_THAT(answer_to(get(inside("events"))), StartsWith("HTTP/1.1 503"));
  first.reset();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_THAT(answer_to(get(inside("events")), 0.5), StartsWith("HTTP/1.1 200"));
}

TEST_F(ViewServer, EndsWithConnectionsStillOpen) {
  const RawClient reader(server_->port()), idle(server_->port());
  reader.send(get(inside("events")));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto start = Clock::now();
  server_.reset();
  EXPECT_LT(seconds_since(start), 2.0);
}

TEST_F(ViewServer, OpensNoPortThatIsTaken) {
  const auto second = LoopbackServer::start(server_->port(), kToken, {});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().line(), HasSubstr("--port"));
}

TEST(ViewToken, IsLongAndNeverTheSame) {
  EXPECT_EQ(random_token().size(), 32u);
  EXPECT_NE(random_token(), random_token());
  EXPECT_TRUE(is_token(random_token()));
  EXPECT_FALSE(is_token("short"));
  EXPECT_FALSE(is_token("../../../../../../../../"));
}

}  // namespace
}  // namespace halflight
