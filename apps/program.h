#pragma once

#include <csignal>

#include "inktrace/inktrace.h"

/// What the programs have in common: how they end.
namespace inktrace {

// Exit status besides 0, done.
constexpr int kBadInput = 1;  ///< or a run that failed
constexpr int kBadUsage = 2;

/// Of an Error that ends the program.
inline int exit_status(const Error& error) {
    return error.kind() == Error::Kind::usage ? kBadUsage : kBadInput;
}

/// Ends the program as the signal would have, less half-written files.
extern "C" inline void end_cleanly(int signal) {
    remove_unfinished_files();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

inline void watch_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        // nohup, and shells for what they run in the background, ask to have some ignored.
        if (std::signal(signal, end_cleanly) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    // A full disk quota or a closed pipe then fails the write, which says so and cleans up.
    for (const int signal : {SIGXFSZ, SIGPIPE}) std::signal(signal, SIG_IGN);
}

}  // namespace inktrace
