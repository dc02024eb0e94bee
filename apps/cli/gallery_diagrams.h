#pragma once

#include <string>

namespace inktrace::cli {

/// The parts of the paper's Figure 4 as SVG: 'a' the stencil, 'b' a stencil across an edge, 'c' a
/// disc that crosses one.
std::string stencil_diagram(char part);

}  // namespace inktrace::cli
