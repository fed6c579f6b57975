#include "server/store/log_end.hpp"

#include "server/store/record.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <memory>
#include <string_view>

namespace scanloom::store {

Result<Revision> end_of_log(rocksdb::DB& database, const std::string& store, SessionId session) {
    const auto unknown = [&](std::string_view what, std::string_view advice = kBringBackOrRemove) {
        return Error{Errc::kDataLoss, fmt::format("the store {} cannot tell where the log of session {} ends ({}); {}",
                                                  store, session, what, advice)};
    };
    const KeyRange range = entries_of(session);
    const std::unique_ptr<rocksdb::Iterator> iterator(database.NewIterator({}));
    iterator->SeekForPrev(range.end);
    if (const auto& status = iterator->status(); !status.ok()) {
        if (code_of(status) == Errc::kDataLoss) return unknown(status.ToString());
        return unknown(status.ToString(), "if its disk is well again, start the server again");
    }
    if (!iterator->Valid() || iterator->key().compare(range.begin) < 0) return Revision{0};
    const auto revision = revision_of(iterator->key().ToStringView());
    if (!revision) return unknown("the key of the last entry");
    return *revision;
}

} // namespace scanloom::store
