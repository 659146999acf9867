# softsim::spectra: what softsim/ext/spectra.hpp needs besides the library. Spectra is headers only; some packages of it
# come without CMake files, so it is looked for by its header. Programs that take in an installed softsim add the path
# of Spectra's headers themselves.
find_path(SPECTRA_INCLUDE_DIR Spectra/SymGEigsShiftSolver.h REQUIRED)
add_library(softsim_spectra INTERFACE)
add_library(softsim::spectra ALIAS softsim_spectra)
target_link_libraries(softsim_spectra INTERFACE softsim::softsim)
target_include_directories(softsim_spectra SYSTEM INTERFACE ${SPECTRA_INCLUDE_DIR})
