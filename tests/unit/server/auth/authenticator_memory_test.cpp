#include "server/auth/authenticator.hpp"

#include "tests/support/failing_allocation.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <new>

namespace scanloom::auth {
namespace {

using testing_support::allocations_left;

const std::string kSecret = "the secret";

TokenSet tokens(Role role) {
    Token token{"one", hash_of(kSecret), role, {"*"}, {}};
    token.limits.connections = 1;
    return TokenSet({std::make_shared<const Token>(std::move(token))});
}

/// Calls `act` with only so many allocations. @return whether these sufficed
template <class Act>
bool suffices(int allocations, const Act& act) {
    allocations_left = allocations;
    try {
        act();
    } catch (const std::bad_alloc&) {
        return false;
    }
    allocations_left.reset();
    return true;
}

TEST(AuthenticatorMemory, FailedGrantLeavesNoConnection) {
    const std::string session = "a session whose name is allocated";
    int allocations = 0;
    for (bool is_granted = false; !is_granted; ++allocations) {
        Authenticator authenticator(tokens(Role::kRobot));
        std::shared_ptr<Credential> credential;
        is_granted =
            suffices(allocations, [&] { credential = authenticator.grant_robot_link(kSecret, session, "a").value(); });
        ASSERT_EQ(authenticator.grant_robot_link(kSecret, session, "b").has_value(), !is_granted) << allocations;
        credential.reset();
        ASSERT_TRUE(authenticator.grant_robot_link(kSecret, session, "b")) << allocations;
    }
    EXPECT_GT(allocations, 5) << "the credential, its control block, and its entries";
}

TEST(AuthenticatorMemory, FailedReplacementChangesNothing) {
    int allocations = 0;
    for (bool is_replaced = false; !is_replaced; ++allocations) {
        Authenticator authenticator(tokens(Role::kRobot));
        const auto credential = authenticator.grant_robot_link(kSecret, "lab", "a").value();
        TokenSet viewers = tokens(Role::kViewer);
        is_replaced = suffices(allocations, [&] { authenticator.replace(std::move(viewers)); });
        ASSERT_EQ(credential->token() == nullptr, is_replaced) << allocations;
        ASSERT_EQ(authenticator.admit(kSecret).value()->role, is_replaced ? Role::kViewer : Role::kRobot);
    }
    EXPECT_GT(allocations, 3) << "the tokens, the changes, and the refusal";
}

} // namespace
} // namespace scanloom::auth
