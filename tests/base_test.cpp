// Text, colours and parallel loops.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/color.h"
#include "base/parallel.h"
#include "base/text.h"

namespace ink::test {
namespace {

using Words = std::vector<std::string_view>;

// ---- Text ----

TEST(Trim, TakesBlanksFromTheEndsOnly) {
    EXPECT_EQ(trim(" \t a b \r\n"), "a b");
    EXPECT_EQ(trim(" \n "), "");
    EXPECT_EQ(trim(""), "");
}

TEST(Split, KeepsEmptyPieces) {
    EXPECT_EQ(split("a, b ,c", ','), (Words{"a", "b", "c"}));
    EXPECT_EQ(split("a,,b", ','), (Words{"a", "", "b"}));
    EXPECT_EQ(split(",", ','), (Words{"", ""}));
    EXPECT_EQ(split("", ','), (Words{""}));
}

TEST(ToLower, LeavesWhatIsNotAsciiAlone) { EXPECT_EQ(to_lower("Ab-9\xc3\x84Z"), "ab-9\xc3\x84z"); }

TEST(ParseDouble, ReadsTheWholeTextOrNothing) {
    EXPECT_EQ(parse_double("0.5"), 0.5);
    EXPECT_EQ(parse_double(" +1.5e3 "), 1500.0);
    EXPECT_EQ(parse_double("-.25"), -0.25);
    for (const char* text : {"", " ", "1.5x", "1,5", "1 2", "+-1", "--1", "0x10", "1e400", "e5"}) {
        EXPECT_FALSE(parse_double(text)) << text;
    }
}

TEST(ParseInt, ReadsTheWholeTextOrNothing) {
    EXPECT_EQ(parse_int("42"), 42);
    EXPECT_EQ(parse_int(" +7 "), 7);
    EXPECT_EQ(parse_int("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
    for (const char* text : {"", "1.0", "1e3", "0x10", "9223372036854775808", "+-1", "one"}) {
        EXPECT_FALSE(parse_int(text)) << text;
    }
}

TEST(ParseHexNumber, ReadsUpToThirtyTwoBits) {
    EXPECT_EQ(parse_hex_number("ff"), 255U);
    EXPECT_EQ(parse_hex_number("FFffFFff"), 0xFFFFFFFFU);
    for (const char* text : {"", "g", "-1", "0x1", "100000000"}) {
        EXPECT_FALSE(parse_hex_number(text)) << text;
    }
}

TEST(Closest, FindsAWordWithAFewWrongLetters) {
    const Words flags{"line-width", "line-color", "lines", "size", "dpi"};
    EXPECT_EQ(closest("line-width", flags), "line-width");
    EXPECT_EQ(closest("line-wdth", flags), "line-width");
    EXPECT_EQ(closest("linecolour", flags), "line-color");
    EXPECT_EQ(closest("sise", flags), "size");
}

TEST(Closest, FindsNothingForAStrangeWord) {
    EXPECT_EQ(closest("temperature", {"line-width", "size"}), "");
    EXPECT_EQ(closest("anything", {}), "");
}

// ---- Colours ----

TEST(Srgb, AgreesWithTheStandardAtKnownPoints) {
    EXPECT_EQ(srgb_encode(0.0F), 0.0F);
    EXPECT_FLOAT_EQ(srgb_encode(1.0F), 1.0F);
    EXPECT_FLOAT_EQ(srgb_decode(1.0F), 1.0F);
    EXPECT_NEAR(srgb_decode(0.5F), 0.214041, 1e-6);
    EXPECT_NEAR(srgb_encode(0.18F), 0.461356, 1e-6);
}

TEST(Srgb, HasNoStepBetweenItsTwoBranches) {
    EXPECT_NEAR(srgb_encode(0.0031308F), srgb_encode(0.0031309F), 2e-6);
    EXPECT_NEAR(srgb_decode(0.04045F), srgb_decode(0.0404501F), 2e-6);
}

TEST(Srgb, ComesBackFromLinearForEveryByte) {
    for (int byte = 0; byte <= 255; ++byte) {
        const float display = static_cast<float>(byte) / 255.0F;
        EXPECT_NEAR(srgb_encode(srgb_decode(display)), display, 1e-6) << byte;
    }
}

TEST(Srgb, GrowsFromByteToByte) {
    float before = -1.0F;
    for (int byte = 0; byte <= 255; ++byte) {
        const auto v = static_cast<std::uint8_t>(byte);
        const Color linear = srgb_decode(Rgb8{v, v, v});
        EXPECT_GT(linear.r, before);
        EXPECT_EQ(linear, (Color{linear.r, linear.r, linear.r}));
        before = linear.r;
    }
}

TEST(ParseColor, ReadsEveryForm) {
    EXPECT_EQ(parse_color("#f80"), (Rgb8{255, 136, 0}));
    EXPECT_EQ(parse_color("#Ff8000"), (Rgb8{255, 128, 0}));
    EXPECT_EQ(parse_color("255, 128,0"), (Rgb8{255, 128, 0}));
    EXPECT_EQ(parse_color("white"), (Rgb8{255, 255, 255}));
    EXPECT_EQ(parse_color("grey"), parse_color("gray"));
    EXPECT_EQ(parse_color("aliceblue"), (Rgb8{240, 248, 255}));
    EXPECT_EQ(parse_color("SteelBlue"), (Rgb8{70, 130, 180}));
    EXPECT_EQ(parse_color("yellowgreen"), (Rgb8{154, 205, 50}));
    EXPECT_FALSE(parse_color("steel"));
    EXPECT_EQ(parse_color("orange"), parse_color("#ffa500"));
}

TEST(ParseColor, RefusesWhatIsNoColour) {
    for (const char* text : {"", "#", "#ff", "#ffff", "#fffffff", "#ggg", "1,2", "1,2,3,4",
                             "256,0,0", "-1,0,0", "0.5,0,0", "mauvish", "ffffff"}) {
        EXPECT_FALSE(parse_color(text)) << text;
    }
}

TEST(ParseColor, ReadsWhatToStringWrites) {
    for (const Rgb8 color : {Rgb8{0, 0, 0}, Rgb8{1, 2, 3}, Rgb8{255, 254, 16}}) {
        EXPECT_EQ(parse_color(to_string(color)), color);
    }
    EXPECT_EQ(to_string(Rgb8{255, 0, 10}), "#ff000a");
}

// ---- Parallel loops ----

constexpr std::size_t kCount = 1000;

class ParallelFor : public testing::TestWithParam<int> {};

TEST_P(ParallelFor, VisitsEveryIndexOnce) {
    std::vector<std::atomic<int>> visits(kCount);
    parallel_for(kCount, GetParam(), [&](std::size_t i, std::size_t) { ++visits[i]; });
    for (const auto& count : visits) EXPECT_EQ(count, 1);
}

TEST_P(ParallelFor, GivesNoTwoCallsAtOneTimeTheSameWorker) {
    const int threads = GetParam() > 0 ? GetParam() : hardware_threads();
    std::vector<std::atomic<int>> calls(static_cast<std::size_t>(threads));
    std::atomic<bool> shared = false;
    parallel_for(200, GetParam(), [&](std::size_t, std::size_t worker) {
        if (calls.at(worker).fetch_add(1) != 0) shared = true;
        std::this_thread::sleep_for(std::chrono::microseconds(50));
        --calls[worker];
    });
    EXPECT_FALSE(shared);
}

TEST_P(ParallelFor, BeginsNoOtherCallForAWorkerWhileItWaitsForALoopWithin) {
    const int threads = GetParam() > 0 ? GetParam() : hardware_threads();
    std::vector<std::atomic<int>> calls(static_cast<std::size_t>(threads));
    std::atomic<bool> shared = false;
    std::atomic<std::size_t> inner = 0;
    with_threads(GetParam(), [&] {
        parallel_for(50, GetParam(), [&](std::size_t, std::size_t worker) {
            if (calls.at(worker).fetch_add(1) != 0) shared = true;
            parallel_for(20, GetParam(), [&](std::size_t, std::size_t) {
                std::this_thread::sleep_for(std::chrono::microseconds(20));
                ++inner;
            });
            --calls[worker];
        });
    });
    EXPECT_FALSE(shared);
    EXPECT_EQ(inner, 50U * 20U);
}

TEST_P(ParallelFor, PassesAnExceptionOn) {
    const auto loop = [&] {
        parallel_for(kCount, GetParam(), [](std::size_t i, std::size_t) {
            if (i == 137) throw std::runtime_error("index 137");
        });
    };
    EXPECT_THROW(loop(), std::runtime_error);
    // And it works again afterwards.
    std::atomic<std::size_t> calls = 0;
    parallel_for(kCount, GetParam(), [&](std::size_t, std::size_t) { ++calls; });
    EXPECT_EQ(calls, kCount);
}

TEST_P(ParallelFor, MayBeEmpty) {
    parallel_for(0, GetParam(), [](std::size_t, std::size_t) { FAIL(); });
}

// 0: all of the machine's; 7: more than a small machine has.
INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(0, 1, 2, 7),
                         testing::PrintToStringParamName());

TEST(ParallelRanges, CoverEveryIndexOnce) {
    for (const std::size_t grain : {std::size_t{1}, std::size_t{64}, 2 * kCount}) {
        std::vector<std::atomic<int>> visits(kCount);
        parallel_ranges(kCount, grain, [&](std::size_t begin, std::size_t end) {
            EXPECT_LT(begin, end);
            for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (const auto& count : visits) EXPECT_EQ(count, 1);
    }
}

TEST(ParallelRanges, PassAnExceptionOn) {
    const auto loop = [] {
        parallel_ranges(kCount, 16, [](std::size_t begin, std::size_t end) {
            if (begin <= 137 && 137 < end) throw std::runtime_error("index 137");
        });
    };
    EXPECT_THROW(loop(), std::runtime_error);
}

}  // namespace
}  // namespace ink::test
