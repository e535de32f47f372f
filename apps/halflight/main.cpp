#include <cstdio>
#include <string>

#include "commands.h"

namespace halflight::app {

int fail(const Error& error) {
  std::fprintf(stderr, "halflight: %s\n", error.line().c_str());
  return error.kind == Error::Kind::input ? kBadInput : kSystemFailure;
}

}  // namespace halflight::app

int main(int argc, char** argv) {
  CLI::App cli{"Lights diffuse 3-D scenes without noise.", "halflight"};
  cli.set_version_flag("--version", HALFLIGHT_VERSION);
  cli.require_subcommand(1);
  cli.failure_message([](const CLI::App*, const CLI::Error& e) {
    return std::string("halflight: ") + e.what() + " (--help lists what there is)\n";
  });
  int status = halflight::app::kGoalMet;
  halflight::app::add_solve(cli, status);
  halflight::app::add_sample(cli, status);
  halflight::app::add_mix(cli, status);
  halflight::app::add_render(cli, status);
  halflight::app::add_view(cli, status);
  halflight::app::add_inspect(cli, status);
  halflight::app::add_scene(cli, status);
  halflight::app::add_reference(cli, status);
  halflight::app::add_compare(cli, status);
  halflight::app::add_reproduce(cli, status);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return cli.exit(e) == 0 ? halflight::app::kGoalMet : halflight::app::kBadInput;
  }
  return status;
}
