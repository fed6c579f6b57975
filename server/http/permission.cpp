#include "server/http/permission.hpp"

namespace scanloom::http {

Need need_of(Operation operation) noexcept {
    switch (operation) {
    case Operation::kViewer:
    case Operation::kViewerAsset:
    case Operation::kLivez:
    case Operation::kReadyz:
    case Operation::kOpenapi:
    case Operation::kGetLogin:
    case Operation::kLogin:
    case Operation::kLogout: return Need::kNothing;
    case Operation::kMetrics: return Need::kAll;
    case Operation::kListBackups:
    case Operation::kMakeBackup: return Need::kKeep;
    case Operation::kListSessions: return Need::kList;
    case Operation::kCreateSession: return Need::kCreate;
    case Operation::kDeleteSession:
    case Operation::kImportMap:
    case Operation::kDeleteWeave:
    case Operation::kExclude:
    case Operation::kLiftExclusion: return Need::kChange;
    case Operation::kGetSession:
    case Operation::kTilePng:
    case Operation::kTileBin:
    case Operation::kTileJson:
    case Operation::kChanges:
    case Operation::kMapPng:
    case Operation::kMapPgm:
    case Operation::kMapYaml:
    case Operation::kMapCsv:
    case Operation::kMapNpy:
    case Operation::kDigest:
    case Operation::kDifference:
    case Operation::kDifferencePng:
    case Operation::kTrajectory:
    case Operation::kFrontiers:
    case Operation::kLandmarks:
    case Operation::kPointsCsv:
    case Operation::kPointsPly:
    case Operation::kPlan:
    case Operation::kCoverage:
    case Operation::kGoal:
    case Operation::kGoals:
    case Operation::kLog:
    case Operation::kLive:
    case Operation::kListExclusions:
    case Operation::kListWeaves:
    case Operation::kStartWeave:
    case Operation::kGetWeave: return Need::kLook;
    case Operation::kAssignGoal: return Need::kGuide;
    }
    return Need::kChange; // a new operation requires kChange until it has a line above
}

} // namespace scanloom::http
