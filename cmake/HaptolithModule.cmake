# Flags shared by all our own targets, and haptolith_module(): one static library per folder of src/haptolith.

add_library(haptolith_flags INTERFACE)
target_include_directories(haptolith_flags INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(haptolith_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  # The same expression gives the same bits in every build: contraction to FMA happens only where the source asks.
  -ffp-contract=off
  $<$<BOOL:${HAPTOLITH_WERROR}>:-Werror>)
if(HAPTOLITH_SANITIZE)
  target_compile_options(haptolith_flags INTERFACE
    -fsanitize=${HAPTOLITH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -Wno-maybe-uninitialized)  # instrumented code misleads g++ 12, in std::regex for one
  target_link_options(haptolith_flags INTERFACE -fsanitize=${HAPTOLITH_SANITIZE})
  if(HAPTOLITH_SANITIZE MATCHES thread)
    target_compile_options(haptolith_flags INTERFACE -Wno-tsan)  # it does not follow the fences in Boost.Asio
  endif()
endif()

# haptolith_module(soil SOURCES a.cpp b.cpp DEPENDS core LIBRARIES PkgConfig::nlopt)
# DEPENDS names folders that stand above this one (docs/architecture.md); LIBRARIES are external and stay private.
function(haptolith_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LIBRARIES;PUBLIC_LIBRARIES" ${ARGN})
  add_library(haptolith_${name} STATIC ${ARG_SOURCES})
  add_library(haptolith::${name} ALIAS haptolith_${name})
  list(TRANSFORM ARG_DEPENDS PREPEND haptolith::)
  target_link_libraries(haptolith_${name}
    PUBLIC haptolith_flags ${ARG_DEPENDS} ${ARG_PUBLIC_LIBRARIES}
    PRIVATE ${ARG_LIBRARIES})
endfunction()
