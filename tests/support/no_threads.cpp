#include <pthread.h>

#include <cstdio>
#include <cstdlib>

/// Ends a test program whose tests start a thread. ThreadSanitizer leaves out the programs that contain this function
/// (label one_thread), because it finds nothing in one thread.
extern "C" int pthread_create(pthread_t* /*thread*/, const pthread_attr_t* /*attributes*/, void* (* /*run*/)(void*),
                              void* /*argument*/) noexcept {
    std::fputs("this test starts a thread: add it to a test program without ONE_THREAD (tests/CMakeLists.txt)\n",
               stderr);
    std::abort();
}
