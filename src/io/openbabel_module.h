#pragma once

#include <cstddef>

// The C interface of the module inktrace-openbabel.so: nothing of Open Babel crosses it.
extern "C" {

/// The atoms of one molecule, or why there are none.
struct InktraceOpenBabelMolecule {
    std::size_t atom_count;
    const unsigned char* atomic_numbers;  ///< one an atom; 0: not an element
    const double* coordinates;            ///< x, y, z of each atom, angstrom
    const char* error;                    ///< null when all went well; may have several lines
};

/// Reads the first molecule of `text` with the MDL reader of Open Babel (`format` "sdf" or "mol").
/// The answer is never null and goes back to inktrace_openbabel_free. Not thread-safe.
InktraceOpenBabelMolecule* inktrace_openbabel_read_mdl(const char* text, std::size_t size,
                                                       const char* format);
void inktrace_openbabel_free(InktraceOpenBabelMolecule* molecule);
}
