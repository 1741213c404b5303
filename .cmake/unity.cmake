# umbra_unity(TARGET): with UMBRA_UNITY, the sources of a folder are compiled together, up to eight at a time, which
# reads each header once for all of them: a build from nothing is faster, one after a change of a file slower. Methods,
# which are what most people change, are not among them.
# Sources with options of their own stay apart, and so do the folders that follow TARGET, relative to the target's.
option(UMBRA_UNITY "Compile the sources of a folder of the libraries together" OFF)

function(umbra_unity target)
  if(NOT UMBRA_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${CMAKE_CURRENT_SOURCE_DIR} ${folder})
    if(folder IN_LIST ARGN)
      continue()
    endif()
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    math(EXPR part "0${${folder}_count} / 8")
    math(EXPR ${folder}_count "0${${folder}_count} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${part})
  endforeach()
endfunction()
