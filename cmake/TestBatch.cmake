# Writes OUTPUT, one source with the text of several tests (SOURCES, separated by commas). Unnamed namespaces become separate
# named ones, so that helpers may have equal names.
string(REPLACE "," ";" files "${SOURCES}")
set(batch "")
foreach(file IN LISTS files)
  file(READ ${file} text)
  get_filename_component(name ${file} NAME_WE)
  file(RELATIVE_PATH shown ${ROOT} ${file})
  string(REPLACE "\nnamespace {\n" "\nnamespace in_${name} {\n" text "${text}")
  string(APPEND batch "#line 1 \"${shown}\"\n${text}\n")
endforeach()
file(WRITE ${OUTPUT} "${batch}")
