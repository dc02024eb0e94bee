#pragma once

namespace inktrace::viewer {

/// Lets the program keep what one picture gives back for the next one. The system would take it and
/// clear it anew, 450 pages a frame of a mesh, while all threads wait for each other in turn: of
/// twenty pauses between two frames, one took more than a millisecond. For programs whose pictures
/// follow each other; they hold up to 128 MB more.
void keep_memory();

}  // namespace inktrace::viewer
