#include "tests/fault/simulation/tokens.hpp"

#include "common/wire/log_codec.hpp"
#include "server/auth/token.hpp"
#include "tests/support/random_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

namespace scanloom::simulation {
namespace {

using namespace std::chrono_literals;

/// A change of the file reaches the links as tasks of the server's machine.
constexpr Duration kUntilNoticed = 1ms;

/// The errors for permanent reasons, which end a robot's program.
constexpr std::array kPermanent = {Errc::kUnauthorized, Errc::kFull, Errc::kTooLarge};

const std::size_t kBeams = testing_support::random_scan(1, 1).ranges.size();

} // namespace

Tokens::Tokens(World& world, std::size_t robots) : world_(world), wrong_secrets_(robots) {
    if (world.chance(0.5)) return;
    accounts_.resize(1 + world.draw(robots));
    for (std::size_t n = 0; n < accounts_.size(); ++n) {
        auto& account = accounts_[n];
        account.name = fmt::format("token-{}", n);
        account.secret = fmt::format("secret-{}", n);
        auto& limits = account.limits;
        if (world.chance(0.5)) limits.connections = 1 + world.draw(2);
        if (world.chance(0.5))
            limits.bytes_per_second = auth::kBytesPerSecondMin + static_cast<double>(world.draw(2'000));
        if (world.chance(0.3)) limits.sessions = 1;
        if (world.chance(0.2)) limits.beams = kBeams - 1;
    }
    for (auto& [secret, until] : wrong_secrets_) {
        if (world.chance(0.8)) continue;
        secret = world.chance(0.5) ? "" : "not-a-secret";
        until = world.now() + world.between(0s, 15s);
    }
}

auth::TokenSet Tokens::in_file() const {
    std::vector<auth::TokenRef> tokens;
    for (const auto& account : accounts_) {
        if (account.grant == Grant::kRemoved) continue;
        const auto role = account.grant == Grant::kViewer ? auth::Role::kViewer : auth::Role::kRobot;
        const std::string sessions = account.grant == Grant::kOtherSessions ? "other-*" : "session-?";
        tokens.push_back(std::make_shared<const auth::Token>(
            auth::Token{account.name, auth::hash_of(account.secret), role, {sessions}, account.limits}));
    }
    return auth::TokenSet(std::move(tokens));
}

/// Changes an account, and records which refusals have no reason any more.
template <class Change>
void Tokens::change(Account& account, Change how) {
    for (const Errc code : kPermanent) {
        if (refuses(account, code)) account.refused_until[code] = world_.now();
    }
    how(account);
    account.changed = world_.now();
    world_.note("the token changes: " + account.name, static_cast<std::uint64_t>(account.grant));
}

void Tokens::edit() {
    change(accounts_[world_.draw(accounts_.size())], [this](Account& account) {
        const bool was_valid = account.grant == Grant::kValid;
        account.grant = was_valid ? static_cast<Grant>(1 + world_.draw(3)) : Grant::kValid;
        if (world_.chance(0.8)) return;
        account.limits.sessions = auth::Limits{}.sessions;
        account.limits.beams = auth::Limits{}.beams;
    });
}

void Tokens::calm() {
    for (auto& account : accounts_) {
        change(account, [](Account& calmed) {
            calmed.grant = Grant::kValid;
            calmed.limits.sessions = auth::Limits{}.sessions;
            calmed.limits.beams = auth::Limits{}.beams;
        });
    }
}

std::string Tokens::secret_of(std::size_t robot) const {
    if (is_open()) return "";
    const auto& [wrong, until] = wrong_secrets_[robot];
    return world_.now() < until ? wrong : accounts_[robot % accounts_.size()].secret;
}

const Tokens::Account* Tokens::find(std::string_view secret) const {
    const auto found = std::ranges::find(accounts_, secret, &Account::secret);
    return found == accounts_.end() ? nullptr : &*found;
}

bool Tokens::refuses(const Account& account, Errc code) {
    switch (code) {
    case Errc::kUnauthorized: return account.grant != Grant::kValid;
    case Errc::kFull: return account.limits.sessions == 1;
    case Errc::kTooLarge: return account.limits.beams < kBeams;
    default: return false;
    }
}

bool Tokens::explains(const wire::Hello& hello, Errc code, Time since) const {
    if (is_open()) return false;
    const auto* account = find(hello.token);
    if (account == nullptr) return code == Errc::kUnauthorized;
    const auto ended = account->refused_until.find(code);
    return refuses(*account, code) || (ended != account->refused_until.end() && ended->second >= since);
}

// Checks --------------------------------------------------------------------------------------------------------------

void Tokens::check_scans(const wire::Hello& hello, std::span<const Scan> scans) {
    if (is_open()) return;
    const auto* account = find(hello.token);
    // A valid token may have been changed a moment ago.
    if (!account || (account->grant != Grant::kValid && world_.now() > account->changed + kUntilNoticed))
        return fail(fmt::format("scans of robot '{}' were accepted without a permission", hello.robot));
    const auto too_large = [&](const Scan& scan) { return scan.ranges.size() > account->limits.beams; };
    if (std::ranges::any_of(scans, too_large))
        fail(fmt::format("scans of robot '{}' with more beams than its token allows were accepted", hello.robot));
}

void Tokens::check_connections(const wire::Hello& hello, std::size_t robots) {
    const auto* account = find(hello.token);
    if (account && robots > account->limits.connections)
        fail(fmt::format("{} robots are connected with '{}', its limit is {}", robots, account->name,
                         account->limits.connections));
}

/// At most the rate, one second of it that was saved, and one second of it that is paid for later.
void Tokens::check_bytes(const wire::Hello& hello, std::size_t bytes, Duration since_granted) {
    const auto* account = find(hello.token);
    if (account == nullptr) return;
    const double seconds = std::chrono::duration<double>(since_granted).count() + 2.0;
    if (static_cast<double>(bytes) > account->limits.bytes_per_second * seconds + 1.0)
        fail(fmt::format("{} bytes of robot '{}' were read, more than its token allows", bytes, hello.robot));
}

void Tokens::check_sessions(store::MemoryScanLog& durable) {
    std::map<std::string, std::size_t> created;
    for (const auto& stored : durable.sessions().value())
        ++created[wire::decode_session(stored.record.value()).value().created_by];
    for (const auto& account : accounts_) {
        if (created[account.name] > account.limits.sessions)
            fail(fmt::format("{} sessions were created with '{}'", created[account.name], account.name));
    }
}

void Tokens::fail(std::string sentence) {
    if (outcome_.failures.size() < 10) outcome_.failures.push_back(std::move(sentence)); // one fault repeats
}

void Tokens::count(std::string_view kind) {
    world_.note(kind);
    ++outcome_.figures[fmt::format("refused_{}", kind)];
}

fault::Outcome Tokens::take_outcome() { return std::exchange(outcome_, {}); }

} // namespace scanloom::simulation
