# SPDX-License-Identifier: Apache-2.0
# Run by `cpack -G TGZ` over the installed files: adds the libraries that they need, all but glibc's,
# to lib/ssdo, with the licences of the packages that these are from. The binary finds libraries there
# by its RPATH, which, other than a RUNPATH, counts for the libraries of libraries too.
if(NOT CPACK_GENERATOR STREQUAL "TGZ")
  return()
endif()
find_program(patchelf patchelf)
if(NOT patchelf)
  message(FATAL_ERROR "patchelf is missing, which makes the bundle relocatable; install it")
endif()

file(GLOB binary ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/bin/ssdo
                 ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*/bin/ssdo)
cmake_path(GET binary PARENT_PATH bin)
cmake_path(GET bin PARENT_PATH prefix)
file(GLOB_RECURSE module ${prefix}/lib*/ssdo_images.so)
cmake_path(GET module PARENT_PATH libraries)
cmake_path(RELATIVE_PATH libraries BASE_DIRECTORY ${bin} OUTPUT_VARIABLE from_bin)

set(glibc "^(ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util|anl|nsl|mvec))\\.so")
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${binary} MODULES ${module}
     RESOLVED_DEPENDENCIES_VAR found UNRESOLVED_DEPENDENCIES_VAR missing
     PRE_EXCLUDE_REGEXES ${glibc})
if(missing)
  message(FATAL_ERROR "The bundle lacks ${missing}: no file of that name is found")
endif()

# Each library under the name that it is asked for by.
foreach(library ${found})
  file(REAL_PATH ${library} file)
  cmake_path(GET library FILENAME name)
  cmake_path(GET file FILENAME file_name)
  file(COPY ${file} DESTINATION ${libraries})
  if(NOT name STREQUAL file_name)
    file(RENAME ${libraries}/${file_name} ${libraries}/${name})
  endif()
  execute_process(COMMAND ${patchelf} --remove-rpath ${libraries}/${name}
                  COMMAND_ERROR_IS_FATAL ANY)
endforeach()
execute_process(COMMAND ${patchelf} --force-rpath --set-rpath \$ORIGIN/${from_bin} ${binary}
                COMMAND_ERROR_IS_FATAL ANY)
list(LENGTH found count)
message(STATUS "The bundle has ${count} libraries")

find_program(dpkg dpkg)
if(dpkg)
  # dpkg knows files by the paths that they had before /lib became a link to /usr/lib.
  set(paths ${found})
  foreach(library ${found})
    file(REAL_PATH ${library} file)
    string(REGEX REPLACE "^/usr" "" short ${file})
    list(APPEND paths ${file} ${short})
  endforeach()
  execute_process(COMMAND ${dpkg} -S ${paths} OUTPUT_VARIABLE owners ERROR_QUIET)
  string(REGEX MATCHALL "[^\n:]+(:[a-z0-9]+)?: /" owners "${owners}")
  foreach(owner ${owners})
    string(REGEX REPLACE ":.*" "" package "${owner}")
    if(EXISTS /usr/share/doc/${package}/copyright)
      configure_file(/usr/share/doc/${package}/copyright
                     ${prefix}/share/doc/ssdo/libraries/${package} COPYONLY)
    endif()
  endforeach()
endif()
