# Warnings and sanitizers as one interface target, so that no folder repeats them.
add_library(ada4571_compile_options INTERFACE)
# GCC 12 takes `"text" + string` for a copy onto itself as soon as it optimises fully (PR 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  set(ada4571_no_restrict $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
endif()
# On ARM of 32 bits GCC notes at every span what GCC 7.1 changed; older code is never linked.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_SYSTEM_PROCESSOR MATCHES "^arm")
  set(ada4571_no_psabi -Wno-psabi)
endif()
# Several files as one translation unit: a file's own names may shadow those of its neighbours, and what the
# optimiser believes to see goes with what it happens to inline.
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  set(ada4571_neighbours $<$<COMPILE_LANGUAGE:CXX>:-Wno-shadow -Wno-error=maybe-uninitialized
    -Wno-error=array-bounds -Wno-error=stringop-overflow -Wno-error=stringop-overread -Wno-error=free-nonheap-object>)
endif()
target_compile_options(ada4571_compile_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wcast-align -Wundef
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Woverloaded-virtual -Wextra-semi>
  ${ada4571_no_restrict} ${ada4571_no_psabi} ${ada4571_neighbours}
  $<$<BOOL:${ADA4571_WERROR}>:-Werror>)
if(ADA4571_SANITIZE)
  target_compile_options(ada4571_compile_options INTERFACE
    -fsanitize=${ADA4571_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -Wno-maybe-uninitialized) # GCC sees it where the sanitizer's own code is, std::regex included
  target_link_options(ada4571_compile_options INTERFACE -fsanitize=${ADA4571_SANITIZE})
endif()
