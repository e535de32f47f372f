// The files that a scene file names, without reading the scene.
#pragma once

#include <filesystem>
#include <vector>

namespace halflight {

// Buffers and pictures of a glTF, material libraries and pictures of an OBJ. Of an OBJ only the
// first mebibyte is looked at, which is where exporters name the libraries. What cannot be read has
// none. Of a map with options ("map_Kd -s 2 2 1 wood.png") the file's name may come with others
// that are no files.
std::vector<std::filesystem::path> files_of_scene(const std::filesystem::path& scene);

}  // namespace halflight
