# Flags of all targets of this project, and haptolith_module(): one static library per folder of src/haptolith.

add_library(haptolith_flags INTERFACE)
target_include_directories(haptolith_flags INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(haptolith_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  # Results are bit-identical in every build: contraction to FMA happens only where the source requests it.
  -ffp-contract=off
  $<$<BOOL:${HAPTOLITH_WERROR}>:-Werror>)
# Eigen's vectors sum in another order on each processor.
target_compile_definitions(haptolith_flags INTERFACE EIGEN_DONT_VECTORIZE)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  # NEON is part of every processor. SVE, which is not, crashes g++ 12, and without a choice Highway's functions are inlined everywhere.
  target_compile_definitions(haptolith_flags INTERFACE HWY_COMPILE_ONLY_STATIC TOOLCHAIN_MISS_SYS_AUXV_H)
endif()
if(HAPTOLITH_SANITIZE)
  target_compile_options(haptolith_flags INTERFACE
    -fsanitize=${HAPTOLITH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -Wno-maybe-uninitialized)  # false positives of g++ 12 in instrumented code, such as std::regex
  # The instrumented kernel of each instruction set takes almost a minute to compile: the widest two and the scalar one suffice.
  target_compile_definitions(haptolith_flags INTERFACE "HWY_DISABLED_TARGETS=(HWY_SSSE3 | HWY_SSE4)")
  target_link_options(haptolith_flags INTERFACE -fsanitize=${HAPTOLITH_SANITIZE})
  if(HAPTOLITH_SANITIZE MATCHES thread)
    target_compile_options(haptolith_flags INTERFACE -Wno-tsan)  # ThreadSanitizer does not support the fences in Boost.Asio
  endif()
endif()

# haptolith_unity(haptolith_soil): compiles a target's sources in batches of twelve, which takes half the time; a changed file
# then recompiles its batch. Some sources are compiled separately: those that Highway compiles once for each instruction set
# (they include themselves), those with separate definitions, and those with the property HAPTOLITH_ALONE. CMake's UNITY_BUILD
# is not used, because it writes absolute names into its batches, which disables the compiler cache for other checkouts.
option(HAPTOLITH_UNITY "Compile several sources at a time: quicker from nothing, slower after a change" OFF)
function(haptolith_unity target)
  if(HAPTOLITH_UNITY)
    cmake_language(EVAL CODE "cmake_language(DEFER CALL haptolith_make_batches ${target})")  # after all its sources have been added
  endif()
endfunction()
function(haptolith_make_batches target)
  get_target_property(sources ${target} SOURCES)
  set(kept "")
  set(batched "")
  foreach(source IN LISTS sources)
    get_filename_component(file ${source} ABSOLUTE)
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${file})
    set(alone "")
    get_source_file_property(alone ${source} COMPILE_DEFINITIONS)
    get_source_file_property(kept_alone ${source} HAPTOLITH_ALONE)
    if(kept_alone)
      set(alone TRUE)
    elseif(NOT alone AND source MATCHES "\\.cpp$" AND EXISTS ${file} AND NOT name MATCHES "^build/")
      file(STRINGS ${file} alone REGEX "HWY_TARGET_INCLUDE" LIMIT_COUNT 1)
    elseif(NOT alone)
      set(alone TRUE)
    endif()
    if(alone)
      list(APPEND kept ${source})
    else()
      list(APPEND batched ${name})
    endif()
  endforeach()
  list(LENGTH batched count)
  math(EXPR batches "(${count} + 11) / 12")
  set(number 0)
  while(number LESS batches)
    math(EXPR first "${number} * 12")
    list(SUBLIST batched ${first} 12 part)
    list(TRANSFORM part REPLACE "(.+)" "#include \"\\1\"")
    list(JOIN part "\n" text)
    set(batch ${CMAKE_CURRENT_BINARY_DIR}/${target}_${number}.cpp)
    file(GENERATE OUTPUT ${batch} CONTENT "${text}\n")
    list(APPEND kept ${batch})
    math(EXPR number "${number} + 1")
  endwhile()
  set_target_properties(${target} PROPERTIES SOURCES "${kept}")
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  # For types in unnamed namespaces, which are as private in a batch as in a source.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# haptolith_precompile(tests LIBRARIES fmt::fmt HEADERS <vector>): headers that most sources of a kind include, compiled once.
# haptolith_precompiled(test_core tests): a target of that kind. Sources must still include all headers that they need, because
# clang-tidy does not use precompiled headers.
option(HAPTOLITH_PRECOMPILED_HEADERS "Compile headers that most sources include once" ON)
file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/empty.cpp CONTENT "// For targets that only precompile headers.\n")
function(haptolith_precompile kind)
  cmake_parse_arguments(ARG "POSITION_INDEPENDENT" "" "LIBRARIES;HEADERS" ${ARGN})
  add_library(haptolith_precompiled_${kind} OBJECT ${PROJECT_BINARY_DIR}/empty.cpp)
  target_link_libraries(haptolith_precompiled_${kind} PRIVATE haptolith_flags ${ARG_LIBRARIES})
  target_precompile_headers(haptolith_precompiled_${kind} PRIVATE ${ARG_HEADERS})
  set_target_properties(haptolith_precompiled_${kind} PROPERTIES POSITION_INDEPENDENT_CODE ${ARG_POSITION_INDEPENDENT})
  # Allows cache hits of ccache in another checkout.
  target_compile_options(haptolith_precompiled_${kind} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()
function(haptolith_precompiled target kind)
  if(HAPTOLITH_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM haptolith_precompiled_${kind})
  endif()
endfunction()

# haptolith_quickly_compiled(test_core): code whose compilation takes longer than its execution: the command line, tests.
function(haptolith_quickly_compiled target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(HAPTOLITH_SANITIZE)
    target_compile_options(${target} PRIVATE -O0)
  endif()
endfunction()

# haptolith_module(soil SOURCES a.cpp b.cpp DEPENDS core LIBRARIES PkgConfig::nlopt)
# DEPENDS names folders on which this one may depend (docs/contributing/architecture.md); LIBRARIES are external and private.
function(haptolith_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LIBRARIES;PUBLIC_LIBRARIES" ${ARGN})
  add_library(haptolith_${name} STATIC ${ARG_SOURCES})
  add_library(haptolith::${name} ALIAS haptolith_${name})
  list(TRANSFORM ARG_DEPENDS PREPEND haptolith::)
  target_link_libraries(haptolith_${name}
    PUBLIC haptolith_flags ${ARG_DEPENDS} ${ARG_PUBLIC_LIBRARIES}
    PRIVATE ${ARG_LIBRARIES})
  set_target_properties(haptolith_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  haptolith_precompiled(haptolith_${name} library)
  haptolith_unity(haptolith_${name})
endfunction()

# haptolith_shared_library(haptolith_library haptolith SOURCES a.cpp LIBRARIES haptolith::lab)
# libhaptolith.so, as haptolith::haptolith: exports only the names in version.map.
function(haptolith_shared_library target output_name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(version_map ${PROJECT_SOURCE_DIR}/src/haptolith/c_api/version.map)
  add_library(${target} SHARED ${ARG_SOURCES})
  add_library(haptolith::${output_name} ALIAS ${target})
  target_include_directories(${target} INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include)
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES})
  haptolith_precompiled(${target} library)
  haptolith_unity(${target})
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${output_name} EXPORT_NAME ${output_name} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    LINK_DEPENDS ${version_map})
  target_compile_definitions(${target} PRIVATE HAPTO_BUILDING)
  if(WIN32)  # one file, for which Visual Studio makes its import library with lib /def
    set_target_properties(${target} PROPERTIES PREFIX "" RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
      ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
    target_link_options(${target} PRIVATE -static LINKER:--output-def,${PROJECT_BINARY_DIR}/lib/${output_name}.def)
    return()
  endif()
  target_link_options(${target} PRIVATE
    LINKER:--version-script=${version_map} LINKER:--as-needed)
  if(NOT HAPTOLITH_SANITIZE)  # the program defines the sanitizers' functions
    target_link_options(${target} PRIVATE LINKER:-z,defs)
  endif()
endfunction()

# haptolith_install_library(haptolith_library HEADERS a.h): with headers, its part of find_package(haptolith), and its .pc file.
function(haptolith_install_library target)
  cmake_parse_arguments(ARG "" "" "HEADERS" ${ARGN})
  get_target_property(name ${target} OUTPUT_NAME)
  install(TARGETS ${target} EXPORT ${name}Targets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
  install(FILES ${ARG_HEADERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/haptolith COMPONENT development)
  install(EXPORT ${name}Targets NAMESPACE haptolith:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/haptolith COMPONENT development)
  file(RELATIVE_PATH HAPTOLITH_PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

# haptolith_embed_toml(soils built_in_soils.cpp HEADER haptolith/... TYPE BuiltInSoil FUNCTION builtInSoils)
# Generates a source, in the current binary folder, from the TOML, Python, R, OBJ and JSON files in a folder of the project.
function(haptolith_embed_toml folder output)
  cmake_parse_arguments(ARG "" "HEADER;TYPE;FUNCTION" "" ${ARGN})
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.toml
       ${PROJECT_SOURCE_DIR}/${folder}/*.py ${PROJECT_SOURCE_DIR}/${folder}/*.R
       ${PROJECT_SOURCE_DIR}/${folder}/*.obj ${PROJECT_SOURCE_DIR}/${folder}/*.json)
  list(JOIN files "," file_list)  # part of the command, so that a removed file triggers it
  set(embed ${PROJECT_SOURCE_DIR}/cmake/EmbedToml.cmake)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DFILES=${file_list} -DHEADER=${ARG_HEADER} -DTYPE=${ARG_TYPE} -DFUNCTION=${ARG_FUNCTION}
            -DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${output} -P ${embed}
    DEPENDS ${files} ${embed}
    VERBATIM)
endfunction()
