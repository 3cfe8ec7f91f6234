# Run by CPack when all packages are laid out: gives each what Debian asks of a package.
find_program(shlibdeps dpkg-shlibdeps)
if(NOT shlibdeps)
  message(FATAL_ERROR "dpkg-shlibdeps, which finds the libraries that a package depends on, is not there: install dpkg-dev")
endif()
file(GLOB packages RELATIVE ${CPACK_TEMPORARY_DIRECTORY} ${CPACK_TEMPORARY_DIRECTORY}/*)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(package ${packages})
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${package}/usr)
  # Licence and changelog, for each package.
  set(documents ${root}/share/doc/${package})
  configure_file(${CPACK_VPM_SOURCE_DIR}/LICENSE ${documents}/copyright COPYONLY)
  file(REMOVE ${documents}/LICENSE)
  file(WRITE ${documents}/changelog "vpm (${CPACK_PACKAGE_VERSION}) bookworm; urgency=medium

  * As CHANGELOG.md tells.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  execute_process(COMMAND gzip -9 -n ${documents}/changelog COMMAND_ERROR_IS_FATAL ANY)
  # What lintian warns of and is meant, with the reasons.
  set(overrides ${CPACK_VPM_SOURCE_DIR}/scripts/packaging/lintian/${package})
  if(EXISTS ${overrides})
    configure_file(${overrides} ${root}/share/lintian/overrides/${package} COPYONLY)
  endif()
  # Libraries are found in the system's folders, not beside the program.
  file(GLOB_RECURSE binaries ${root}/bin/* ${root}/lib/*.so*)
  foreach(binary ${binaries})
    if(NOT IS_SYMLINK ${binary})
      file(RPATH_REMOVE FILE ${binary})
    endif()
  endforeach()
  # Completions of zsh that come with a package.
  if(EXISTS ${root}/share/zsh/site-functions)
    file(RENAME ${root}/share/zsh/site-functions ${root}/share/zsh/vendor-completions)
  endif()
endforeach()
