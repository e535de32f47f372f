# Flags shared by every target of the project, through the interface target halflight_options.
add_library(halflight_options INTERFACE)
# Same bytes from the same input: no contraction into fused multiply-add, no -ffast-math.
# AVX2 is the instruction set that Embree is pinned to as well (rays/ray_scene.cpp).
target_compile_options(halflight_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
  -ffp-contract=off -mavx2)
if(HALFLIGHT_WERROR)
  target_compile_options(halflight_options INTERFACE -Werror)
endif()
if(HALFLIGHT_SANITIZE)
  target_compile_options(halflight_options INTERFACE
    -fsanitize=${HALFLIGHT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(halflight_options INTERFACE -fsanitize=${HALFLIGHT_SANITIZE})
endif()
if(HALFLIGHT_COVERAGE)
  target_compile_options(halflight_options INTERFACE --coverage)
  target_link_options(halflight_options INTERFACE --coverage)
endif()
