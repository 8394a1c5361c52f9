# cmake -DFILES=a.toml,b.toml -DHEADER=haptolith/scene_file/built_in_soils.h -DTYPE=BuiltInSoil -DFUNCTION=builtInSoils
#       -DOUTPUT=built_in_soils.cpp -P EmbedToml.cmake
# Makes one source of TOML files, scripts or drawings, so that the program knows them wherever it is started.
string(REPLACE "," ";" files "${FILES}")
set(entries "")
foreach(file ${files})
  get_filename_component(name ${file} NAME)
  string(REGEX REPLACE "\\.(toml|obj)$" "" name ${name})
  file(READ ${file} text)
  string(APPEND entries "    {\"${name}\", R\"toml(${text})toml\"sv},\n")
endforeach()
file(WRITE ${OUTPUT}
"// Made of files by cmake/EmbedToml.cmake.
#include \"${HEADER}\"

namespace haptolith {

std::span<const ${TYPE}> ${FUNCTION}() {
  using namespace std::string_view_literals;
  static constexpr ${TYPE} kFiles[]{
${entries}  };
  return kFiles;
}

}  // namespace haptolith
")
