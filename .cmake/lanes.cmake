# umbra_lanes(SOURCE...): of these, the files that include core/base/lanes.h are compiled so that loops over lanes become vector
# code, which they do only where neither errno, traps nor rounding modes (which CGAL's users keep) are to be watched. No result
# changes by that. They cannot share headers that were precompiled without.
function(umbra_lanes)
  foreach(source IN LISTS ARGN)
    file(STRINGS ${source} found REGEX "^#include \"umbra/core/base/lanes.h\"")
    if(found)
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS
        "-fno-math-errno;-fno-trapping-math;-fno-rounding-math" SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()
