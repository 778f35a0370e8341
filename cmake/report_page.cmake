# meristem_report_page(TARGET FOLDER): the page of the reports, one HTML file around a place for its figures, as C++ in
# the library TARGET (renderer/report/page.h). FOLDER holds its parts. The one thing from npm, uPlot, is fetched when
# the build is set up, at the version and with the digest of FOLDER/package-lock.json; a page needs no network.
function(meristem_report_page target folder)
  find_program(NPM npm REQUIRED)
  set(modules ${CMAKE_BINARY_DIR}/web)
  set(uplot ${modules}/node_modules/uplot/dist/uPlot.iife.min.js)
  add_custom_command(OUTPUT ${uplot}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${modules}
    COMMAND ${CMAKE_COMMAND} -E copy ${folder}/package.json ${folder}/package-lock.json ${modules}
    COMMAND ${NPM} ci --prefix ${modules} --ignore-scripts --no-audit --no-fund --loglevel=error
    DEPENDS ${folder}/package-lock.json
    WORKING_DIRECTORY ${folder}
    COMMENT "Fetching uPlot"
    VERBATIM)
  set(scripts format charts sections comparison report)
  list(TRANSFORM scripts REPLACE ".+" "${folder}/\\0.js")
  set(page ${CMAKE_BINARY_DIR}/generated/renderer/report_page.cpp)
  add_custom_command(OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -DPAGE=${page} -DFOLDER=${folder} -DUPLOT=${uplot} "-DSCRIPTS=${scripts}"
            -P ${CMAKE_SOURCE_DIR}/cmake/embed_page.cmake
    DEPENDS ${uplot} ${scripts} ${folder}/report.html ${folder}/report.css ${CMAKE_SOURCE_DIR}/cmake/embed_page.cmake
    COMMENT "Inlining the report page"
    VERBATIM)
  target_sources(${target} PRIVATE ${page})
endfunction()
