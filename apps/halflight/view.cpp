// halflight view SCENE: a page on this machine that shows the light while it is being found.
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "commands.h"
#include "halflight/base/parallel.h"
#include "halflight/base/quantities.h"
#include "halflight/view/view_routes.h"
#include "interrupt.h"
#include "number_checks.h"
#include "scene_arguments.h"
#include "solve_arguments.h"
#include "view_page.h"

namespace halflight::app {
namespace {

// A page that is just being opened still gets to know why there is nothing to see.
constexpr double kSecondsToTellOfFailure = 3.0;
constexpr int kLargestPort = 65535;

struct LiveViewArguments {
  SceneArguments scene;
  SolveArguments solve;
  int port = 0;
  std::string token;
};

// Refers to the arguments.
Result<ViewPlan> plan_of(const SolveArguments& arguments) {
  const Result<SolvePlan> plan = resolve(arguments);
  if (!plan) return tl::unexpected(plan.error());
  ViewPlan result;
  result.options = plan->options;
  result.complete = [&arguments](SolveOptions& options, const World& world) -> Result<void> {
    SolvePlan completed{options, {}};
    if (auto ok = complete(completed, arguments, world); !ok) return ok;
    options = completed.options;
    return {};
  };
  if (plan->goals.links) result.links = *plan->goals.links;
  if (!arguments.time.empty()) result.seconds = *parse_duration(arguments.time);
  return result;
}

// Until the user ends it, or there is nothing to serve.
Result<void> wait_for_end(const ViewSession& session, const LoopbackServer& server) {
  using Clock = std::chrono::steady_clock;
  Progress progress;
  const Interruptible interruptible(progress);
  std::optional<Clock::time_point> failed;
  while (!progress.cancelled()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (!server.is_open())
      return system_error("the system lets no more connections be opened", server.url(),
                          "close other programs, and start the live view again");
    if (!failed && session.failure()) failed = Clock::now();
    if (failed && Clock::now() - *failed > std::chrono::duration<double>(kSecondsToTellOfFailure))
      return tl::unexpected(*session.failure());
  }
  return {};
}

Result<void> serve(const LiveViewArguments& arguments) {
  if (!arguments.token.empty() && !is_token(arguments.token))
    return input_error("a token has 16 to 64 letters, digits, - or _", "--token",
                       "leave it out to get a random one");
  const Result<ViewPlan> plan = plan_of(arguments.solve);
  if (!plan) return tl::unexpected(plan.error());
  // A wrong name is told at once; what is in the file is read while the page opens.
  std::error_code ignored;
  if (!std::filesystem::exists(arguments.scene.path, ignored))
    return input_error("there is no such file", arguments.scene.path.string(), "check the name");

  ViewSession session([&arguments] { return load(arguments.scene); }, *plan);
  const std::string token = arguments.token.empty() ? random_token() : arguments.token;
  const auto server =
      LoopbackServer::start(arguments.port, token, view_routes(session, view_page()));
  if (!server) return tl::unexpected(server.error());
  if (std::printf("%s\n", (*server)->url().c_str()) < 0 || std::fflush(stdout) != 0)
    return system_error("the page's address cannot be written to the standard output", "",
                        "check that there is room");

  Result<void> ended = wait_for_end(session, **server);
  session.stop();
  return ended;
}

}  // namespace

void add_view(CLI::App& cli, int& status) {
  auto arguments = std::make_shared<LiveViewArguments>();
  CLI::App& command =
      *cli.add_subcommand("view", "watch and steer the light in a browser on this machine");
  add_scene_arguments(command, arguments->scene);
  add_solve_arguments(command, arguments->solve);
  command.add_option("--port", arguments->port, "of the page's address on 127.0.0.1; 0: any")
      ->check(from_to(0, kLargestPort))
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--token", arguments->token,
                  "part of the page's address, to keep it the same over restarts")
      ->type_name("TEXT")
      ->default_str("random");
  command.callback([arguments, &status] {
    set_thread_count(arguments->solve.threads);
    const Result<void> done = serve(*arguments);
    status = done ? kGoalMet : fail(done.error());
  });
}

}  // namespace halflight::app
