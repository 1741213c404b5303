# umbra_unity(TARGET [JOIN "FOLDER FOLDER ..."...]): with UMBRA_UNITY, the sources of a folder, and those of the
# folders that one JOIN names, are compiled together, up to twenty at a time. That reads each header, and compiles what
# templates become, once for all of them: a build from nothing is faster, one after a change of a file slower. A method that is one
# file in a folder of its own stays alone, as do sources with options of their own. FOLDERs are relative to the target's.
option(UMBRA_UNITY "Compile sources of the libraries together" OFF)

function(umbra_unity target)
  if(NOT UMBRA_UNITY)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" JOIN ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${CMAKE_CURRENT_SOURCE_DIR} ${folder})
    foreach(joined IN LISTS ARG_JOIN)
      separate_arguments(folders UNIX_COMMAND "${joined}")
      if(folder IN_LIST folders)
        set(folder ${joined})
      endif()
    endforeach()
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    math(EXPR part "0${${folder}_count} / 20")
    math(EXPR ${folder}_count "0${${folder}_count} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${part})
  endforeach()
endfunction()
