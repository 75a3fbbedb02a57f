# Toolchain of the presets arm64, armhf, riscv64 and s390x: Debian's cross compiler, and a foreign
# Debian in a folder that holds the libraries (lib/docs/boards.md):
#   cmake --preset arm64 -DADA4571_SYSROOT=FOLDER
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ADA4571_DEBIAN_ARCH ADA4571_SYSROOT)
set(triplet_arm64 aarch64-linux-gnu)
set(triplet_armhf arm-linux-gnueabihf)
set(triplet_riscv64 riscv64-linux-gnu)
set(triplet_s390x s390x-linux-gnu)
if(NOT DEFINED triplet_${ADA4571_DEBIAN_ARCH})
  message(FATAL_ERROR "ADA4571_DEBIAN_ARCH must be arm64, armhf, riscv64 or s390x")
endif()
set(triplet ${triplet_${ADA4571_DEBIAN_ARCH}})
if(NOT IS_DIRECTORY "${ADA4571_SYSROOT}/usr/include")
  message(FATAL_ERROR "give the folder of a Debian for ${ADA4571_DEBIAN_ARCH}, with the libraries' "
                      "development packages: -DADA4571_SYSROOT=FOLDER")
endif()

set(CMAKE_SYSTEM_NAME Linux)
string(REGEX REPLACE "-.*" "" CMAKE_SYSTEM_PROCESSOR ${triplet})
set(CMAKE_C_COMPILER ${triplet}-gcc)
set(CMAKE_CXX_COMPILER ${triplet}-g++)
set(CMAKE_SYSROOT ${ADA4571_SYSROOT})
set(CMAKE_LIBRARY_ARCHITECTURE ${triplet})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${ADA4571_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR}
  ${ADA4571_SYSROOT}/usr/lib/${triplet}/pkgconfig:${ADA4571_SYSROOT}/usr/share/pkgconfig)
# Tests are looked for when they run, on the machine that can run them.
set(CMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE PRE_TEST)
