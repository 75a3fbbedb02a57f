# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# Run by `cmake --install`, with `doc` the folder of the pages below the prefix. The pages link to one
# another as they lie in the sources; installed some of them lie elsewhere.
get_filename_component(prefix "${CMAKE_INSTALL_PREFIX}" ABSOLUTE)
set(root "$ENV{DESTDIR}${prefix}/${doc}")
# Where a link leads in the sources, and where when installed. Without their square brackets, which
# would hold a list of CMake together.
set(moved
  "(lib/docs/" "(docs/"
  "(lib/python/examples/" "(examples/"
  "(tools/examples/" "(examples/"
  "(lib/include/" "(../../../include/"
  "(dts/" "(../../ada4571/dts/"
  "(udev/README.md)" "(udev.md)"
  "(../../dts/" "(../../../ada4571/dts/"
  "(../../tools/examples/" "(../examples/"
  "(../../python/examples/" "(../../examples/")
file(GLOB_RECURSE pages "${root}/*.md")
foreach(page ${pages})
  file(READ "${page}" text)
  string(REPLACE "[tools/packages.sh](tools/packages.sh)" "`tools/packages.sh`" changed "${text}")
  set(links ${moved})
  while(links)
    list(POP_FRONT links from to)
    string(REPLACE "${from}" "${to}" changed "${changed}")
  endwhile()
  if(NOT changed STREQUAL text)
    file(WRITE "${page}" "${changed}")
  endif()
endforeach()
