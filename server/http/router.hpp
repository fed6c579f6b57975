#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::http {

/// All operations of the API. api.cpp maps each of them to its handler.
enum class Operation {
    kViewer,
    kViewerAsset,
    kLivez,
    kReadyz,
    kMetrics,
    kOpenapi,
    kGetLogin,
    kLogin,
    kLogout,
    kListSessions,
    kCreateSession,
    kGetSession,
    kDeleteSession,
    kImportMap,
    kTilePng,
    kTileBin,
    kTileJson,
    kChanges,
    kMapPng,
    kMapPgm,
    kMapYaml,
    kMapCsv,
    kMapNpy,
    kDigest,
    kDifference,
    kDifferencePng,
    kTrajectory,
    kFrontiers,
    kLandmarks,
    kPointsCsv,
    kPointsPly,
    kPlan,
    kCoverage,
    kGoal,
    kAssignGoal,
    kGoals,
    kLog,
    kLive,
    kStartWeave,
    kListWeaves,
    kGetWeave,
    kDeleteWeave,
    kExclude,
    kListExclusions,
    kLiftExclusion,
    kListBackups,
    kMakeBackup,
};

/// A method and a path that select an operation. A segment of the pattern is literal, or "{name}" with an optional
/// ending ("{y}.png"), which matches any text before that ending.
struct Route {
    std::string_view method; ///< a GET route also answers HEAD
    std::string_view pattern;
    Operation operation;
};

[[nodiscard]] std::span<const Route> routes() noexcept;

/// The text that the named segments of a pattern matched.
class Arguments {
public:
    void add(std::string_view name, std::string value) { values_.emplace_back(name, std::move(value)); }

    /// @param name  occurs in the route's pattern
    [[nodiscard]] const std::string& operator[](std::string_view name) const;

private:
    std::vector<std::pair<std::string_view, std::string>> values_;
};

struct Match {
    Operation operation;
    Arguments arguments;
};

struct NoSuchPath {};

/// The path exists, but not with this method.
struct MethodNotAllowed {
    std::string allow; ///< for the Allow field: "GET, HEAD, DELETE"
};

using Routing = std::variant<Match, NoSuchPath, MethodNotAllowed>;

/// Finds the operation for a method and the decoded segments of a path.
[[nodiscard]] Routing find_route(std::string_view method, const std::vector<std::string>& segments);

} // namespace scanloom::http
