# Writes the header code_versions.h: for each method of shadows/methods.def a hash of the sources that its answers and
# their errors depend on. A change of one method's room changes that method's hash alone.
# cmake -D SOURCE=<top folder> -D OUT=<header> -P code_versions.cmake
function(hash_of result)
  set(hashes "")
  foreach(file IN LISTS ARGN)
    file(SHA256 ${file} hash)
    string(APPEND hashes ${hash})
  endforeach()
  string(SHA256 all "${hashes}")
  set(${result} ${all} PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE shared ${SOURCE}/core/*.h ${SOURCE}/core/*.cpp ${SOURCE}/shadows/geometry/*.h ${SOURCE}/shadows/geometry/*.cpp
     ${SOURCE}/shadows/light_rays/*.h ${SOURCE}/shadows/light_rays/*.cpp ${SOURCE}/shadows/bins/*.h ${SOURCE}/shadows/bins/*.cpp
     ${SOURCE}/shadows/maps/*.h ${SOURCE}/shadows/maps/*.cpp ${SOURCE}/bench/lab/*.h ${SOURCE}/bench/lab/*.cpp)
file(GLOB contract ${SOURCE}/shadows/*.h ${SOURCE}/shadows/*.cpp ${SOURCE}/bench/compare/record.*
     ${SOURCE}/bench/compare/image_figures.* ${SOURCE}/bench/sweep/cell.h ${SOURCE}/bench/sweep/cell.cpp ${SOURCE}/bench/sweep/views.*)
list(SORT shared)
list(SORT contract)
hash_of(common ${shared} ${contract})

file(STRINGS ${SOURCE}/shadows/methods.def lines REGEX "^METHOD")
set(table "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^METHOD\\(([a-z_0-9]+)\\).*" "\\1" name "${line}")
  file(GLOB main ${SOURCE}/shadows/*/${name}.cpp)
  get_filename_component(room "${main}" DIRECTORY)
  file(GLOB_RECURSE own ${room}/*.h ${room}/*.cpp)
  list(SORT own)
  hash_of(own_hash ${own})
  string(SHA256 version "${common}${own_hash}")
  string(SUBSTRING ${version} 0 32 version)
  string(APPEND table "    {\"${name}\", \"${version}\"},\n")
endforeach()
list(LENGTH lines count)
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT "#pragma once
#include <array>
#include <string_view>
#include <utility>
namespace umbra {
inline constexpr std::array<std::pair<std::string_view, std::string_view>, @count@> kCodeVersions{{
@table@}};
}  // namespace umbra
")
