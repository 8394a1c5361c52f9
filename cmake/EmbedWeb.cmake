# cmake -DDIST=web/dist -DOUTPUT=web_files.cpp -P EmbedWeb.cmake
# Generates one source from the page's files, so that the program serves them without any other files.
file(GLOB_RECURSE files RELATIVE ${DIST} ${DIST}/*)
list(SORT files)
set(symbols "")
set(entries "")
set(number 0)
foreach(file ${files})
  # A compiler cache reads only the source, not the files that the assembler includes: a changed file must change the source.
  file(SHA256 ${DIST}/${file} digest)
  string(APPEND symbols
"// ${digest}
__asm__(
    HAPTOLITH_BEGIN
    \"haptolith_web_${number}: .incbin \\\"${DIST}/${file}\\\"\\n\"
    \"haptolith_web_${number}_end: .byte 0\\n\"
    \".globl haptolith_web_${number}, haptolith_web_${number}_end\\n\"
    HAPTOLITH_END);
extern \"C\" const char haptolith_web_${number}[], haptolith_web_${number}_end[];
")
  string(APPEND entries
"      {\"/${file}\", {haptolith_web_${number}, static_cast<std::size_t>(haptolith_web_${number}_end - haptolith_web_${number})}},
")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT}
"// Made of web/dist by cmake/EmbedWeb.cmake.
#include \"haptolith/viewer/web_files.h\"

#include <cstddef>

#ifdef _WIN32
#define HAPTOLITH_BEGIN \".section .rdata,\\\"dr\\\"\\n\"
#define HAPTOLITH_END \".text\\n\"
#else
#define HAPTOLITH_BEGIN \".pushsection .rodata\\n\"
#define HAPTOLITH_END \".popsection\\n\"
#endif

${symbols}
namespace haptolith {

std::span<const WebFile> webFiles() {
  static const WebFile kFiles[]{
${entries}  };
  return kFiles;
}

}  // namespace haptolith
")
