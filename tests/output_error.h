#pragma once

#include <string>

#include "base/error.h"

namespace ink::test {

/// The message of the OutputError that `call` throws; empty without one.
template <class Call>
std::string output_error(const Call& call) {
    try {
        call();
    } catch (const OutputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace ink::test
