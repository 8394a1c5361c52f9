# cmake -DSOILS=a.toml,b.toml -DOUTPUT=built_in_soils.cpp -P EmbedSoils.cmake
# Makes one source of soil files, so that the program knows them wherever it is started.
string(REPLACE "," ";" files "${SOILS}")
set(entries "")
foreach(file ${files})
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} text)
  string(APPEND entries "    {\"${name}\", R\"toml(${text})toml\"},\n")
endforeach()
file(WRITE ${OUTPUT}
"// Made of soils/*.toml by cmake/EmbedSoils.cmake.
#include \"haptolith/scenario/built_in_soils.h\"

namespace haptolith {

std::span<const BuiltInSoil> builtInSoils() {
  static constexpr BuiltInSoil kSoils[]{
${entries}  };
  return kSoils;
}

}  // namespace haptolith
")
