# cmake -DFILES=a.toml,b.toml -DHEADER=haptolith/scene_file/built_in_soils.h -DTYPE=BuiltInSoil -DFUNCTION=builtInSoils
#       -DOUTPUT=built_in_soils.cpp -P EmbedToml.cmake
# Generates one source from TOML files, scripts or meshes, so that they are part of the program.
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
