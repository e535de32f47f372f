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
if(HALFLIGHT_FUZZ)
  set(halflight_fuzz_sanitizers address,undefined,float-cast-overflow)
  target_compile_options(halflight_options INTERFACE
    -fsanitize=fuzzer-no-link,${halflight_fuzz_sanitizers} -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  target_link_options(halflight_options INTERFACE -fsanitize=${halflight_fuzz_sanitizers})
  target_compile_definitions(halflight_options INTERFACE
    FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION _GLIBCXX_ASSERTIONS)
endif()
