#include "server/store/postgres_session_name.hpp"

#include "common/wire/log_codec.hpp"

namespace scanloom::store::postgres {

SessionName name_in(std::string_view record) {
    const auto decoded = wire::decode_session(record);
    return decoded ? SessionName{decoded->name, decoded->replaces} : SessionName();
}

} // namespace scanloom::store::postgres
