#include "tests/fault/corrupt_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/original_stores.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/store_damage.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <random>
#include <sstream>
#include <string>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;

enum class Served { kEqual, kShortened, kRefused, kWrong };

Served compare(const Held& held, const Held& original) {
    if (held.log == original.log) return held.digests == original.digests ? Served::kEqual : Served::kWrong;
    const bool is_beginning =
        held.log.size() < original.log.size() && std::equal(held.log.begin(), held.log.end(), original.log.begin());
    const auto right = undisturbed_digests(held.log, fleet_options());
    return is_beginning && right && *right == held.digests ? Served::kShortened : Served::kWrong;
}

/// Returns how the server serves a session now. An answer that ends early counts as a refusal.
Served look_at(const ServerProcess& server, const std::string& session, const Held& original) {
    if (test::http_request(server.http_port(), "GET", "/api/v1/sessions/" + session).status == 404)
        return Served::kShortened;
    try {
        return compare(ask_for(server.http_port(), session), original);
    } catch (const std::exception&) {
        return Served::kRefused;
    }
}

/// Returns whether the server reported damage of the store. Other warnings (for example of a viewer that is not built)
/// do not count.
bool has_complained(const fs::path& log) {
    std::istringstream lines(store::bytes_of(log));
    for (std::string line; std::getline(lines, line);) {
        const bool warns = line.find(" error ") != std::string::npos || line.find(" warning ") != std::string::npos;
        if (warns && (line.find("damaged") != std::string::npos || line.find("missing") != std::string::npos))
            return true;
    }
    return false;
}

/// Returns whether the damage is like that of a crash: the end of the last write is missing, or one of its sectors was
/// never written, or the session itself is missing because its creation was part of that write. A zeroed sector before
/// the last write is not: the server refuses to start.
bool is_like_a_crash(const std::string& damage) {
    return damage.find(".log ends after") != std::string::npos || damage.find(".log is zero from") != std::string::npos;
}

class Trial {
public:
    Trial(const Run& run, const OriginalStores& originals, std::uint64_t seed)
        : random_(seed), original_(originals.all()[random_() % originals.all().size()]),
          server_(run.server, place_.path()) {
        store::copy_store(original_.path, place_.path() / "store");
        damage_ = damage(place_.path() / "store", random_);
    }

    Outcome run() {
        server_.start();
        if (!server_.becomes_ready()) {
            ++outcome_.figures["refused_to_start"];
            const int code = server_.wait();
            if (code != 1 || server_.last_words().empty()) {
                complain(fmt::format("the server exited with {} instead of refusing to start: {}", code,
                                     server_.last_words()));
            }
            return std::move(outcome_);
        }
        bool is_all_equal = true;
        for (const auto& [name, original] : original_.sessions) {
            const Served served = look_at(server_, name, original);
            is_all_equal = is_all_equal && served == Served::kEqual;
            count(served, name);
        }
        if (is_all_equal) ++outcome_.figures["harmless"];
        return std::move(outcome_);
    }

private:
    void count(Served served, const std::string& name) {
        switch (served) {
        case Served::kEqual: ++outcome_.figures["sessions_equal"]; return;
        case Served::kRefused: ++outcome_.figures["sessions_refused"]; return;
        case Served::kWrong:
            outcome_.digest_equal = false;
            complain(fmt::format("session '{}' is served with scans or maps that differ from the stored ones", name));
            return;
        case Served::kShortened:
            ++outcome_.figures["sessions_shortened"];
            if (!is_like_a_crash(damage_) && !has_complained(place_.path() / "log")) {
                complain(fmt::format("scans at the end of session '{}' are missing, and this is not reported", name));
            }
            return;
        }
    }

    void complain(std::string sentence) {
        outcome_.failures.push_back(fmt::format("{} ({}; {})", sentence, original_.what, damage_));
    }

    TemporaryDirectory place_;
    std::mt19937_64 random_;
    const OriginalStore& original_;
    ServerProcess server_;
    std::string damage_;
    Outcome outcome_;
};

} // namespace

Outcome run_corrupt_row(const Run& run) {
    const OriginalStores originals;
    auto outcome = run_cases(run, {.row = "corrupt", .at_once = 2, .run = [&](std::uint64_t seed, std::uint64_t) {
                                       return Trial(run, originals, seed).run();
                                   }});
    outcome.acknowledged = OriginalStores::kSessions * OriginalStores::kScans;
    return outcome;
}

} // namespace scanloom::fault
