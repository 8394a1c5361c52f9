# cmake -DFOLDER=scenes/tiles -DOUTPUT=ready_tile_files.cpp -P EmbedTiles.cmake
# Generates one source with the settled soil that ships with the program, as EmbedWeb.cmake does for the page.
file(GLOB files RELATIVE ${FOLDER} ${FOLDER}/*.tile)
list(SORT files)
set(symbols "")
set(entries "")
set(number 0)
foreach(file ${files})
  # A compiler cache reads only the source, not the files that the assembler includes: a changed file must change the source.
  file(SHA256 ${FOLDER}/${file} digest)
  string(APPEND symbols
"// ${digest}
__asm__(
    HAPTOLITH_BEGIN
    \"haptolith_tile_${number}: .incbin \\\"${FOLDER}/${file}\\\"\\n\"
    \"haptolith_tile_${number}_end: .byte 0\\n\"
    \".globl haptolith_tile_${number}, haptolith_tile_${number}_end\\n\"
    HAPTOLITH_HIDE(haptolith_tile_${number}) HAPTOLITH_HIDE(haptolith_tile_${number}_end)
    HAPTOLITH_END);
extern \"C\" HAPTOLITH_HIDDEN const char haptolith_tile_${number}[];
extern \"C\" HAPTOLITH_HIDDEN const char haptolith_tile_${number}_end[];
")
  string(APPEND entries
"  if (name == \"${file}\") {
    return {haptolith_tile_${number}, static_cast<std::size_t>(haptolith_tile_${number}_end - haptolith_tile_${number})};
  }
")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT}
"// Made of scenes/tiles by cmake/EmbedTiles.cmake.
#include \"haptolith/bed/start/ready_tile.h\"

#include <cstddef>

#ifdef _WIN32
#define HAPTOLITH_BEGIN \".section .rdata,\\\"dr\\\"\\n\"
#define HAPTOLITH_END \".text\\n\"
#define HAPTOLITH_HIDE(symbol)
#define HAPTOLITH_HIDDEN
#else
#define HAPTOLITH_BEGIN \".pushsection .rodata\\n\"
#define HAPTOLITH_END \".popsection\\n\"
#define HAPTOLITH_HIDE(symbol) \".hidden \" #symbol \"\\n\"
#define HAPTOLITH_HIDDEN __attribute__((visibility(\"hidden\")))
#endif

${symbols}
namespace haptolith {

std::string_view readyTileFile([[maybe_unused]] std::string_view name) {
${entries}  return {};
}

}  // namespace haptolith
")
