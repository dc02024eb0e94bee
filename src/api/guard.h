#pragma once

#include <new>

#include "base/error.h"
#include "inktrace/error.h"

namespace ink {

/// Calls `body` and turns what the inside throws into the public error.
template <class Body>
auto guard(const Body& body) {
    using Kind = inktrace::Error::Kind;
    try {
        return body();
    } catch (const Cancelled& error) {
        throw inktrace::Error(Kind::cancelled, error.what());
    } catch (const UsageError& error) {
        throw inktrace::Error(Kind::usage, error.what());
    } catch (const Error& error) {
        throw inktrace::Error(Kind::input, error.what());
    } catch (const std::bad_alloc&) {
        throw inktrace::Error(Kind::input,
                              "out of memory; load less, or ask for a smaller picture");
    }
}

}  // namespace ink
