// Runs one row of faults many times and prints the result as one line of JSON.
#include "tests/fault/row.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace scanloom::fault;

struct Options {
    std::string row; ///< empty: list the rows
    std::uint64_t seed = 1;
    std::uint64_t count = 0; ///< 0: the row's default
    bool is_long = false;
};

void list_rows() {
    const auto about_bytes = [](const Row& row) { return row.about.size(); };
    const auto longest = about_bytes(*std::ranges::max_element(rows(), {}, about_bytes));
    for (const Row& row : rows()) {
        std::cout << fmt::format("  {:<11}{:<{}}  {:>5} {}, long {}\n", row.name, row.about, longest, row.count_short,
                                 row.counts, row.count_long);
    }
}

/// Prints a progress line from time to time.
std::function<void(std::uint64_t)> teller(const Row& row, std::uint64_t count) {
    return [&row, count, printed = std::uint64_t{0}](std::uint64_t done) mutable {
        constexpr std::uint64_t kLines = 20;
        if (count < kLines || done * kLines / count == printed) return;
        printed = done * kLines / count;
        std::cerr << fmt::format("{}: {} of {} {}\n", row.name, done, count, row.counts);
    };
}

bool run_row(const Row& row, const Options& options) {
    const auto count = options.count > 0 ? options.count : options.is_long ? row.count_long : row.count_short;
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome =
        row.run({.seed = options.seed, .count = count, .is_long = options.is_long, .on_progress = teller(row, count)});
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    for (const auto& sentence : outcome.failures) std::cerr << row.name << ": " << sentence << '\n';
    std::cout << json_line(row.name, options.seed, count, took.count(), outcome) << std::endl;
    return outcome.passed();
}

int run(const Options& options) {
    if (options.row.empty()) {
        list_rows();
        return 0;
    }
    bool all_passed = true;
    for (const Row& row : rows()) {
        if (options.row == "all" || options.row == row.name) all_passed = run_row(row, options) && all_passed;
    }
    return all_passed ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN); // connections are cut all the time
    Options options;
    CLI::App app{"Causes one kind of fault of a server or its links, many times, and checks that nothing is lost.\n"
                 "Without a row, lists the rows.",
                 "scanloom-fault"};
    app.add_option("row", options.row, "The row to run, or 'all'")->check([](const std::string& row) {
        return row == "all" || find_row(row) != nullptr ? "" : "there is no row '" + row + "'";
    });
    app.add_option("--seed", options.seed, "Random seed")->capture_default_str();
    app.add_option("--count", options.count, "Number of repetitions, instead of the row's default")
        ->check(CLI::PositiveNumber);
    app.add_flag("--long", options.is_long, "The long form");
    try {
        app.parse(argc, argv);
        return run(options);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& failure) {
        std::cerr << "scanloom-fault: " << failure.what() << '\n';
        return 1;
    }
}
