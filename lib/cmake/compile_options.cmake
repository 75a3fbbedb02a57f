# Warnings and sanitizers as one interface target, so that no folder repeats them.
add_library(ada4571_compile_options INTERFACE)
target_compile_options(ada4571_compile_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wcast-align -Wundef
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Woverloaded-virtual -Wextra-semi>
  $<$<BOOL:${ADA4571_WERROR}>:-Werror>)
if(ADA4571_SANITIZE)
  target_compile_options(ada4571_compile_options INTERFACE
    -fsanitize=${ADA4571_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -Wno-maybe-uninitialized) # GCC sees it where the sanitizer's own code is, std::regex included
  target_link_options(ada4571_compile_options INTERFACE -fsanitize=${ADA4571_SANITIZE})
endif()
