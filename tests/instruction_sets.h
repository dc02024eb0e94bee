#pragma once

#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <cstdint>

namespace ink::test {

/// Calls `body` with each instruction set that kernels are built for and this machine has.
template <class Body>
void on_every_instruction_set(const Body& body) {
    int sets = 0;
    for (const std::int64_t target : {HWY_SSSE3, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
        hwy::SetSupportedTargetsForTest(0);
        if ((hwy::SupportedTargets() & target) == 0) continue;
        hwy::SetSupportedTargetsForTest(target);
        SCOPED_TRACE(hwy::TargetName(target));
        body();
        ++sets;
    }
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_GE(sets, 1);
}

}  // namespace ink::test
