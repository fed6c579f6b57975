#include "tests/unit/tidy/source_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace scanloom::tidy {
namespace {

using Names = std::vector<std::string_view>;

/// A folder and the other folders that it may include.
struct Folder {
    std::string_view path;
    Names may_include;
    bool pure = false;  ///< does not use sockets, files, clocks, threads, protobuf or logs
    Names may_use = {}; ///< standard headers that a pure folder may include all the same; it reads no clock
};

// The dependencies of ARCHITECTURE.md. A new folder needs a row here; folders that a row does not list are forbidden.
const std::vector<Folder> kFolders = {
    {.path = "common/archive", .may_include = {}, .pure = true},
    {.path = "common/error", .may_include = {}, .pure = true},
    {.path = "common/files", .may_include = {}},
    {.path = "common/geometry", .may_include = {}, .pure = true},
    {.path = "common/hash", .may_include = {}, .pure = true},
    {.path = "common/json", .may_include = {}, .pure = true},
    {.path = "common/text", .may_include = {}, .pure = true},
    {.path = "common/limits", .may_include = {"common/error"}, .pure = true, .may_use = {"mutex"}},
    {.path = "common/scan", .may_include = {"common/error", "common/geometry"}, .pure = true},
    {.path = "common/ros", .may_include = {"common/geometry"}, .pure = true},
    {.path = "common/ros_map", .may_include = {"common/error", "common/scan"}, .pure = true},
    {.path = "common/app", .may_include = {"common/error", "common/files", "common/net", "common/scan", "common/text"}},
    {.path = "common/net", .may_include = {"common/error", "common/hash", "common/text"}},
    {.path = "common/wire", .may_include = {"common/error", "common/geometry", "common/hash", "common/scan"}},

    {.path = "common/link",
     .may_include = {"common/error", "common/limits", "common/scan", "common/wire"},
     .pure = true,
     .may_use = {"chrono"}},

    {.path = "server/log", .may_include = {}},
    {.path = "server/auth",
     .may_include = {"common/error", "common/files", "common/hash", "common/net", "common/scan", "common/text",
                     "server/log"}},
    {.path = "core/grid", .may_include = {"common/scan"}, .pure = true},
    {.path = "core/classify",
     .may_include = {"common/error", "common/geometry", "common/scan", "core/grid"},
     .pure = true},
    {.path = "core/planning",
     .may_include = {"common/error", "common/geometry", "common/scan", "core/classify", "core/grid"},
     .pure = true},
    {.path = "core/landmarks", .may_include = {"common/error", "common/geometry", "common/scan"}, .pure = true},
    {.path = "core/scan_matching", .may_include = {"common/error", "common/geometry", "common/scan"}, .pure = true},
    {.path = "core/slam",
     .may_include = {"common/error", "common/geometry", "common/scan", "core/scan_matching"},
     .pure = true},
    {.path = "core/mapping",
     .may_include = {"common/error", "common/geometry", "common/hash", "common/scan", "common/text", "core/classify",
                     "core/grid", "core/scan_matching"},
     .pure = true},
    {.path = "core/localization",
     .may_include = {"common/archive", "common/error", "common/geometry", "common/scan", "core/classify", "core/grid",
                     "core/mapping", "core/scan_matching", "core/slam"},
     .pure = true},
    {.path = "server/store", .may_include = {"common", "core/mapping"}},
    {.path = "server/sessions",
     .may_include = {"common", "server/auth", "core/grid", "core/landmarks", "core/localization", "server/log",
                     "core/mapping", "server/store"}},
    {.path = "server/guidance",
     .may_include = {"common", "core/grid", "core/landmarks", "core/mapping", "core/planning", "server/sessions"}},
    {.path = "server/tiles",
     .may_include = {"common/error", "common/geometry", "common/ros_map", "common/scan", "common/text", "core/classify",
                     "core/grid", "core/mapping"}},
    {.path = "server/exchange",
     .may_include = {"common/error", "common/geometry", "common/scan", "core/landmarks", "core/localization"},
     .pure = true},
    {.path = "server/foxglove",
     .may_include = {"common/error", "common/geometry", "common/json", "common/ros", "common/scan", "core/classify",
                     "core/grid", "core/landmarks", "core/localization", "core/mapping", "server/tiles"},
     .pure = true,
     .may_use = {"chrono"}},
    {.path = "server/metrics", .may_include = {"common/error"}},
    {.path = "server/sockets", .may_include = {"common"}},
    {.path = "server/ingest",
     .may_include = {"common", "server/auth", "server/guidance", "core/landmarks", "server/log", "core/mapping",
                     "server/metrics", "core/planning", "server/sessions", "server/sockets", "server/store"}},
    {.path = "server/live/core",
     .may_include = {"common/error", "common/geometry", "common/scan", "common/wire", "core/grid", "core/landmarks",
                     "core/mapping", "server/tiles"},
     .pure = true},
    {.path = "server/live",
     .may_include = {"common", "server/auth", "server/foxglove", "server/guidance", "core/localization", "core/mapping",
                     "server/metrics", "server/sessions", "server/sockets", "server/store", "server/tiles"}},
    {.path = "server/http",
     .may_include = {"common", "server/auth", "core/classify", "server/exchange", "server/foxglove", "core/grid",
                     "server/guidance", "core/landmarks", "server/live", "core/mapping", "server/metrics",
                     "core/planning", "server/sessions", "server/sockets", "server/store", "server/tiles"}},
    {.path = "server/app", .may_include = {"common", "core", "server"}},

    {.path = "sim/drive",
     .may_include = {"common/error", "common/geometry", "common/scan", "core/grid", "core/planning"},
     .pure = true},
    {.path = "sim/robot",
     .may_include = {"common/error", "common/geometry", "common/hash", "common/ros_map", "common/scan", "common/text",
                     "robot_client/sources", "sim"}},
    {.path = "sim",
     .may_include = {"common/error", "common/geometry", "common/ros_map", "common/scan", "core/planning", "sim/drive"},
     .pure = true},
    {.path = "robot_client/sources",
     .may_include = {"common/error", "common/geometry", "common/hash", "common/net", "common/scan"}},
    {.path = "robot_client/lidars",
     .may_include = {"common/error", "common/geometry", "common/hash", "common/net", "common/scan",
                     "robot_client/sources"}},
    {.path = "robot_client/recordings", .may_include = {"common/error", "common/files", "robot_client/sources"}},
    {.path = "robot_client/ros",
     .may_include = {"common/error", "common/geometry", "common/hash", "common/ros", "common/scan",
                     "robot_client/recordings", "robot_client/sources"}},
    {.path = "robot_client/foxglove/core",
     .may_include = {"common/error", "robot_client/recordings", "robot_client/ros"},
     .pure = true},
    {.path = "robot_client/foxglove",
     .may_include = {"common/error", "common/geometry", "common/net", "common/ros_map", "common/scan",
                     "robot_client/recordings", "robot_client/ros", "robot_client/sources", "robot_client/uplink"}},
    {.path = "robot_client/spool",
     .may_include = {"common/error", "common/files", "common/scan", "common/wire", "robot_client/sources"}},
    {.path = "robot_client/uplink", .may_include = {"common", "robot_client/sources", "robot_client/spool"}},
    {.path = "robot_client/client",
     .may_include = {"common", "robot_client/sources", "robot_client/spool", "robot_client/uplink"}},
    {.path = "robot_client/app", .may_include = {"common", "sim", "robot_client"}},
    {.path = "robot_client/examples", .may_include = {}}, // uses only the installed client

    // Experiments combine the simulator and the maps. No other folder does, and no folder includes them.
    {.path = "lab",
     .may_include = {"common", "core/grid", "core/landmarks", "core/mapping", "core/scan_matching", "core/slam",
                     "server/tiles", "sim/drive", "sim", "robot_client/lidars", "robot_client/sources",
                     "robot_client/uplink"}},

    // The load generator runs outside the server: it does not include the server, and no folder includes it.
    {.path = "load/core",
     .may_include = {"common/error", "common/geometry", "common/json", "common/link", "common/scan", "common/wire"},
     .pure = true},
    {.path = "load/net", .may_include = {"common", "load/core", "robot_client/uplink"}},
    {.path = "load/app",
     .may_include = {"common", "load", "sim/drive", "sim", "robot_client/sources", "robot_client/uplink"}},
};

/// A package whose headers only some folders may include.
struct Package {
    std::string_view header; ///< prefix of the header's name
    Names folders;
};

const std::vector<Package> kPackages = {
    {"scanloom/v1/", {"common/wire"}},
    {"foxglove/", {"server/foxglove"}},
    {"google/protobuf/", {"common/wire", "server/foxglove"}},
    {"openssl/", {"common/hash", "common/net", "server/auth", "server/foxglove", "server/http"}},
    {"toml++/", {"server/auth"}},
    {"Eigen/", {"core/landmarks", "core/slam", "robot_client/ros"}},
    {"nanoflann.hpp", {"core/landmarks"}},
    {"spng.h", {"server/tiles"}},
    {"yaml-cpp/", {"common/ros_map"}},
    {"opencv2/", {"server/tiles", "lab"}},
    {"rocksdb/", {"server/store"}},
    {"libpq-fe.h", {"server/store"}},
    {"prometheus/", {"server/auth", "server/metrics"}},
    {"spdlog/",
     {"server/log", "server/sessions", "server/sockets", "server/ingest", "server/live", "server/http", "server/app",
      "robot_client/app"}},
    {"boost/asio",
     {"common/net", "server/sessions", "server/sockets", "server/ingest", "server/live", "server/http", "server/app",
      "sim/robot", "robot_client/foxglove", "robot_client/lidars", "robot_client/sources", "robot_client/spool",
      "robot_client/uplink", "robot_client/client", "robot_client/app", "load/net", "load/app"}},
    {"boost/beast", {"common/net", "server/live", "server/http", "server/app", "robot_client/foxglove", "load/net"}},
    {"bzlib.h", {"robot_client/recordings", "robot_client/sources"}},
    {"lz4frame.h", {"robot_client/recordings"}},
    {"sqlite3.h", {"robot_client/recordings"}},
    {"zlib.h",
     {"robot_client/recordings", "robot_client/sources", "robot_client/spool", "server/foxglove", "server/http",
      "server/tiles"}},
    {"zstd.h", {"common/wire", "robot_client/recordings", "server/foxglove", "server/sessions"}},
    {"CLI/", {"common/app", "server/app", "robot_client/app", "lab", "load/app"}},
};

// Standard headers for files, sockets, clocks, threads and logs.
const Names kOutsideWorld = {
    "barrier",   "chrono",       "condition_variable",
    "csignal",   "cstdio",       "ctime",
    "dirent.h",  "fcntl.h",      "filesystem",
    "fstream",   "future",       "iostream",
    "latch",     "mutex",        "netdb.h",
    "poll.h",    "print",        "pthread.h",
    "semaphore", "shared_mutex", "signal.h",
    "stdio.h",   "stop_token",   "syncstream",
    "thread",    "time.h",       "unistd.h",
};

/// Returns whether `path` is inside `folder`: "server" and "core/mapping" contain "core/mapping/cell.hpp";
/// "server/map" does not.
bool holds(std::string_view folder, std::string_view path) {
    return path.starts_with(folder) && (path.size() == folder.size() || path[folder.size()] == '/');
}

bool any_holds(const Names& folders, std::string_view path) {
    return std::ranges::any_of(folders, [&](std::string_view folder) { return holds(folder, path); });
}

/// Returns the header of an #include line without quotes or brackets.
std::optional<std::string_view> included(std::string_view line) {
    constexpr std::string_view kDirective = "#include ";
    if (!line.starts_with(kDirective) || line.size() < kDirective.size() + 2) return std::nullopt;
    line.remove_prefix(kDirective.size() + 1);
    return line.substr(0, line.find_first_of("\">"));
}

std::optional<std::string> forbidden_arrow(const Folder& folder, std::string_view header) {
    const bool ours = any_holds({"common", "core", "server", "sim", "robot_client", "lab", "load", "tests"}, header);
    if (ours && !holds(folder.path, header) && !any_holds(folder.may_include, header)) {
        return fmt::format("{} may not include {}", folder.path, header);
    }
    for (const auto& package : kPackages) {
        if (header.starts_with(package.header) && !any_holds(package.folders, folder.path)) {
            return fmt::format("{} may not include {}; only {} may", folder.path, header,
                               fmt::join(package.folders, ", "));
        }
    }
    const bool outside = std::ranges::find(kOutsideWorld, header) != kOutsideWorld.end() ||
                         any_holds({"arpa", "netinet", "sys"}, header);
    if (folder.pure && outside && std::ranges::find(folder.may_use, header) == folder.may_use.end()) {
        return fmt::format("{} is pure and may not include {}: files, sockets, clocks, threads and logs stay outside",
                           folder.path, header);
    }
    return std::nullopt;
}

template <class Visit>
void for_each_line(std::string_view text, Visit visit) {
    for (std::size_t number = 1; !text.empty(); ++number) {
        const auto end = std::min(text.find('\n'), text.size());
        visit(number, text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

void check_includes(std::string_view path, std::string_view text, std::vector<std::string>& complaints) {
    if (!any_holds({"common", "core", "server", "sim", "robot_client", "lab", "load"}, path)) return;
    const auto folder = std::ranges::find_if(kFolders, [&](const Folder& row) { return holds(row.path, path); });
    if (folder == kFolders.end()) {
        complaints.push_back(fmt::format("{}: its folder has no row in tests/unit/tidy/source_rules.cpp", path));
        return;
    }
    for_each_line(text, [&](std::size_t number, std::string_view line) {
        if (folder->pure && line.find("_clock::now(") != std::string_view::npos) {
            complaints.push_back(fmt::format("{}:{}: {} is pure and reads no clock", path, number, folder->path));
        }
        const auto header = included(line);
        if (!header) return;
        if (auto forbidden = forbidden_arrow(*folder, *header)) {
            complaints.push_back(fmt::format("{}:{}: {}", path, number, *forbidden));
        }
    });
}

struct ForbiddenWord {
    std::string_view word;
    std::string_view where; ///< prefix of the path
    std::string_view instead;
};

constexpr std::string_view kWaitForTheEvent = "wait for the expected event; a test that sleeps is slow or flaky";

// The words are split so that this file obeys the rules itself.
const std::vector<ForbiddenWord> kForbiddenWords = {
    {"sleep_"
     "for",
     "tests/", kWaitForTheEvent},
    {"sleep_"
     "until",
     "tests/", kWaitForTheEvent},
    {"waitFor"
     "Timeout",
     "tests/", kWaitForTheEvent},
    {"DISABLED"
     "_",
     "tests/", "fix the test or remove it"},
    {"TO"
     "DO",
     "", "do it, or file it where the project keeps its plans"},
    {"FIX"
     "ME",
     "", "fix it, or file it where the project keeps its plans"},
};

void check_words(std::string_view path, std::string_view text, std::vector<std::string>& complaints) {
    for_each_line(text, [&](std::size_t number, std::string_view line) {
        for (const auto& rule : kForbiddenWords) {
            if (!path.starts_with(rule.where) || line.find(rule.word) == std::string_view::npos) continue;
            complaints.push_back(fmt::format("{}:{}: {}: {}", path, number, rule.word, rule.instead));
        }
    });
}

} // namespace

std::vector<std::string> complaints_about(std::string_view path, std::string_view text) {
    std::vector<std::string> complaints;
    if (path.ends_with(".hpp") && !text.starts_with("#pragma once\n")) {
        complaints.push_back(fmt::format("{}: a header starts with #pragma once", path));
    }
    if (path.ends_with(".hpp") || path.ends_with(".cpp")) check_includes(path, text, complaints);
    check_words(path, text, complaints);
    return complaints;
}

} // namespace scanloom::tidy
