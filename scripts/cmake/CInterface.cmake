# palpate_c_library(NAME SOURCE...): libpalpate-NAME.so, the functions palpate_* of these sources over the static library
# palpate_NAME. The sources are objects of their own, palpate_NAME_c, which tests may link, too.
function(palpate_c_library name)
  add_library(palpate_${name}_c OBJECT ${ARGN})
  target_link_libraries(palpate_${name}_c PUBLIC palpate_${name})
  palpate_compile_by_folder(palpate_${name}_c)

  add_library(palpate_${name}_shared SHARED $<TARGET_OBJECTS:palpate_${name}_c>)
  target_link_libraries(palpate_${name}_shared PRIVATE palpate_${name})
  target_include_directories(palpate_${name}_shared INTERFACE $<INSTALL_INTERFACE:include>)
  set(exports ${CMAKE_SOURCE_DIR}/scripts/cmake/c_interface.map)
  target_link_options(palpate_${name}_shared PRIVATE -Wl,--version-script=${exports})
  set_target_properties(palpate_${name}_shared PROPERTIES
    LINKER_LANGUAGE CXX OUTPUT_NAME palpate-${name} EXPORT_NAME ${name} VERSION ${PROJECT_VERSION} SOVERSION 0
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib LINK_DEPENDS ${exports})
endfunction()
