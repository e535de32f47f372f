// Runs the program in a folder of its own, in which a small room and sensors lie ready.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "temporary_folder.h"

namespace halflight {

// A closed room of 4 x 3 x 5 units times `scale` with a lamp under its ceiling and a table.
inline std::string room_obj(double scale) {
  std::string obj = "mtllib room.mtl\n";
  int next = 1;
  const auto quad = [&](std::vector<std::array<double, 3>> corners) {
    for (const auto& c : corners)
      obj += fmt::format("v {} {} {}\n", scale * c[0], scale * c[1], scale * c[2]);
    obj += fmt::format("f {} {} {} {}\n", next, next + 1, next + 2, next + 3);
    next += 4;
  };
  obj += "usemtl wall\n";
  quad({{0, 0, 0}, {0, 0, 5}, {4, 0, 5}, {4, 0, 0}});
  quad({{0, 3, 0}, {4, 3, 0}, {4, 3, 5}, {0, 3, 5}});
  quad({{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}});
  quad({{0, 0, 5}, {0, 3, 5}, {4, 3, 5}, {4, 0, 5}});
  quad({{0, 0, 0}, {0, 3, 0}, {0, 3, 5}, {0, 0, 5}});
  quad({{4, 0, 0}, {4, 0, 5}, {4, 3, 5}, {4, 3, 0}});
  quad({{1, 1, 1}, {1, 1, 3}, {3, 1, 3}, {3, 1, 1}});  // the table's top
  obj += "usemtl lamp\n";
  quad({{1.5, 2.9, 2}, {2.5, 2.9, 2}, {2.5, 2.9, 3}, {1.5, 2.9, 3}});
  return obj;
}

inline constexpr const char* kRoomMaterials =
    "newmtl wall\nKd 0.7 0.6 0.5\nnewmtl lamp\nKd 0.5 0.5 0.5\nKe 10 9 8\n";

inline std::string sensors(double scale) {
  std::string lines;
  for (int i = 0; i < 8; ++i)
    lines += fmt::format("{} 0 {} 0 1 0\n", scale * (0.3 + 0.45 * i), scale * (0.4 + 0.5 * i));
  lines += fmt::format("{} {} {} 0 1 0\n", scale * 2.0, scale, scale * 2.0);
  lines += fmt::format("{} {} 0 0 0 1\n", scale * 2.0, scale * 1.5);
  return lines;
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The last three numbers of each line.
inline std::vector<float> irradiance_of(const std::string& table) {
  std::vector<float> values;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<float> numbers;
    for (float x; words >> x;) numbers.push_back(x);
    if (numbers.size() == 9) values.insert(values.end(), numbers.end() - 3, numbers.end());
  }
  return values;
}

class RoomCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("room.mtl", kRoomMaterials);
    folder_.write("room.obj", room_obj(1.0));
    folder_.write("sensors.txt", sensors(1.0));
  }
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  std::string text(const std::string& name) const { return read_text(path(name)); }

  // What it prints goes to files "out" and "err".
  int run(const std::string& arguments) const {
    const std::string line = "cd '" + folder_.path().string() + "' && '" HALFLIGHT_BINARY "' " +
                             arguments + " >out 2>err";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  // The same, with signals after `delay`; -1: one of them ended it.
  int run_and_signal(const std::string& arguments, std::initializer_list<int> signals,
                     std::chrono::milliseconds delay) {
    const std::string line = "cd '" + folder_.path().string() +
                             "' && exec '" HALFLIGHT_BINARY "' " + arguments + " >out 2>err";
    const pid_t child = fork();
    if (child == 0) {
      for (const int signal : signals) std::signal(signal, SIG_DFL);  // this test may ignore them
      execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
      _exit(127);
    }
    std::this_thread::sleep_for(delay);
    for (const int signal : signals) kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  TemporaryFolder folder_;
};

}  // namespace halflight
