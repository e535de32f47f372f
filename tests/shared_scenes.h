// Where tests find the shared scene corpus, which is not part of the project.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#define HALFLIGHT_NEEDS_SHARED_SCENES()          \
  if (!std::filesystem::exists(shared_scenes())) \
  GTEST_SKIP() << "the shared scenes are not here: " << shared_scenes()

namespace halflight {

inline std::filesystem::path shared_scenes() { return HALFLIGHT_SHARED_SCENES; }

inline nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in);
}

// The scene file of every folder that describes one scene in a camera.json, in order.
inline std::vector<std::filesystem::path> scene_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!std::filesystem::exists(entry.path() / "camera.json")) continue;
    for (const auto& file : std::filesystem::directory_iterator(entry.path()))
      if (file.path().extension() == ".glb" || file.path().extension() == ".obj")
        files.push_back(file.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace halflight
