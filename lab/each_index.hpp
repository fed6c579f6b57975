#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <thread>
#include <vector>

namespace scanloom::lab {

/// Number of threads that for_each_index() uses.
[[nodiscard]] inline std::size_t worker_count() { return std::max(1U, std::thread::hardware_concurrency()); }

/// Calls work(0), work(1), ... work(count - 1), each once, on all of the machine's processors and in any order.
/// Rethrows an exception of `work` when all threads have ended.
/// Threads: work is called on several threads concurrently.
template <class Work>
void for_each_index(std::size_t count, const Work& work) {
    std::atomic<std::size_t> next = 0;
    const auto go = [&] {
        for (std::size_t n = next++; n < count; n = next++) work(n);
    };
    std::vector<std::future<void>> others;
    for (std::size_t n = 1; n < std::min(worker_count(), count); ++n) {
        others.push_back(std::async(std::launch::async, go));
    }
    go();
    for (auto& other : others) other.get();
}

} // namespace scanloom::lab
