#pragma once

/// INKTRACE_MULTIVERSION before a function builds it for baseline x86-64-v2, AVX2 and AVX-512 and
/// picks one when the program starts. It pays for leaf functions that loop over packets; helpers
/// that they call must inline into them. All versions give the same bits: the build forbids fused
/// multiply-add, and lanes are never summed across.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(INKTRACE_NO_MULTIVERSION)
#define INKTRACE_MULTIVERSION \
    __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define INKTRACE_MULTIVERSION
#endif

/// For the helpers of such functions.
#define INKTRACE_INLINE inline __attribute__((always_inline))
