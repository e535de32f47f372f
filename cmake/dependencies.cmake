# What a consumer's build needs as well (headers seen through ours, or compiled code to link):
# found here, and from the same list by the installed halflightConfig.cmake.
set(halflight_exposed_packages
  Threads
  TBB
  "embree 3.13"
  glm
  tl-expected
  fmt
  PNG
  JPEG
  OpenEXR
  draco
  meshoptimizer)
set(halflight_find_dependencies "")
foreach(package IN LISTS halflight_exposed_packages)
  separate_arguments(arguments UNIX_COMMAND "${package}")
  find_package(${arguments} REQUIRED)
  string(APPEND halflight_find_dependencies "find_dependency(${package})\n")
endforeach()

# Header-only, used in sources alone: link as $<BUILD_INTERFACE:...> and a consumer needs none.
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tsl-robin-map REQUIRED)
find_package(Eigen3 REQUIRED)

# Debian brings no CMake package for these: linked by their plain names, here and by a consumer.
find_library(HALFLIGHT_ZSTD zstd REQUIRED)
find_library(HALFLIGHT_HTTPLIB cpp-httplib REQUIRED)
