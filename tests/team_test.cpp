#include "base/team.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/parallel.h"

namespace ink {
namespace {

constexpr int kThreads = 4;

void run(Team& team, const std::function<void()>& lead) {
    parallel_for(kThreads, kThreads,
                 [&](std::size_t k, std::size_t worker) { team.work(k, worker, lead); });
}

TEST(Team, DoesEveryItemOnce) {
    constexpr std::size_t kBeside = 300;
    constexpr std::size_t kLoops = 40;
    constexpr std::size_t kItems = 25;
    std::vector<std::atomic<int>> beside(kBeside);
    std::vector<std::atomic<int>> items(kLoops * kItems);
    std::vector<std::atomic<int>> at_work(kThreads);
    std::atomic<int> most_at_one_time = 0;
    const auto as_worker = [&](std::size_t worker, const auto& work) {
        const int others = at_work[worker]++;
        if (others > most_at_one_time) most_at_one_time = others;
        work();
        --at_work[worker];
    };
    Team team(kBeside, [&](std::size_t item, std::size_t worker) {
        as_worker(worker, [&] { ++beside[item]; });
    });
    int led = 0;
    run(team, [&] {
        for (std::size_t loop = 0; loop < kLoops; ++loop) {
            std::atomic<std::size_t> done = 0;
            team.loop(kItems, [&](std::size_t item, std::size_t worker) {
                as_worker(worker, [&] {
                    ++items[loop * kItems + item];
                    ++done;
                });
            });
            // All calls are over, so that the next loop may build on them.
            EXPECT_EQ(done, kItems);
        }
        ++led;
    });
    EXPECT_EQ(led, 1);
    for (const auto& count : beside) EXPECT_EQ(count, 1);
    for (const auto& count : items) EXPECT_EQ(count, 1);
    EXPECT_EQ(most_at_one_time, 0);
}

TEST(Team, OthersHelpBeforeTheyGoOnBeside) {
    // Without help, the leader would wait for itself: each item waits for the other one's thread.
    Team team(0, {});
    std::atomic<int> there = 0;
    bool met = true;
    parallel_for(2, 2, [&](std::size_t k, std::size_t worker) {
        ++there;
        // Both threads have come, or the machine has but one.
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
        while (there < 2 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
        if (there < 2) return;
        team.work(k, worker, [&] {
            std::atomic<int> begun = 0;
            team.loop(2, [&](std::size_t, std::size_t) {
                ++begun;
                const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(20);
                while (begun < 2) {
                    if (std::chrono::steady_clock::now() > late) {
                        met = false;
                        return;
                    }
                    std::this_thread::yield();
                }
            });
        });
    });
    EXPECT_TRUE(met);
}

TEST(Team, LoopThrowsWhatACallThrows) {
    Team team(10, [](std::size_t, std::size_t) {});
    std::atomic<int> calls = 0;
    bool thrown = false;
    run(team, [&] {
        try {
            team.loop(50, [&](std::size_t item, std::size_t) {
                ++calls;
                if (item == 7) throw std::runtime_error("seven");
            });
        } catch (const std::runtime_error&) {
            thrown = true;
        }
    });
    EXPECT_TRUE(thrown);
    EXPECT_EQ(calls, 50);
}

TEST(Team, EndsWhenTheLeaderThrows) {
    Team team(0, {});
    EXPECT_THROW(run(team, [] { throw std::runtime_error("lost"); }), std::runtime_error);
}

TEST(Team, LeaderDoesWhatIsBesideAlone) {
    std::vector<int> done(12);
    Team team(done.size(), [&](std::size_t item, std::size_t) { ++done[item]; });
    team.work(0, 0, [&] { team.loop(3, [](std::size_t, std::size_t) {}); });
    EXPECT_EQ(done, std::vector<int>(12, 1));
}

}  // namespace
}  // namespace ink
