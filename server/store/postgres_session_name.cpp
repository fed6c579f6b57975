#include "server/store/postgres_session_name.hpp"

#include "common/wire/log_codec.hpp"

namespace scanloom::store::postgres {

SessionName name_in(std::string_view record) {
    const auto decoded = wire::decode_session(record);
    if (!decoded) return {};
    if (decoded->replaces != 0) return {{}, decoded->replaces};
    return {decoded->name, 0};
}

} // namespace scanloom::store::postgres
