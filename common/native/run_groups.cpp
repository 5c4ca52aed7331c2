#include "native/module.h"

#ifdef _WIN32

namespace lab::native {
void run_groups(RunGroup, Bindings, uint32_t) {}
}  // namespace lab::native

#else
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>

#include "error.h"
#include "parallel.h"
#include "platform.h"

namespace lab::native {
namespace {

// A crash in a shader returns to the thread that runs it. The handler has a stack of its own, since the shader's may be full.
// Where the shader has overwritten that, the way back crashes, too, and there is none but out.
thread_local sigjmp_buf way_back;
thread_local bool is_in_shader = false;
thread_local bool is_stack_full = false;
thread_local uintptr_t stack_end = 0;  // its lowest address, 0 where that is unknown
std::atomic<bool> has_crashed = false;
struct sigaction before[NSIG];  // of the program, for crashes elsewhere
static_assert(std::atomic<bool>::is_always_lock_free);
const char* advice() {
    return get_mode() == Mode::checked ? "the sanitizer's last line tells where"
                                       : "as it does for an index outside of an array: --sanitize tells where";
}
uintptr_t find_stack_end() {
    void* end = nullptr;
#ifdef __GLIBC__
    pthread_attr_t attributes;
    size_t size = 0;
    if (pthread_getattr_np(pthread_self(), &attributes) != 0) return 0;
    pthread_attr_getstack(&attributes, &end, &size);
    pthread_attr_destroy(&attributes);
#endif
    return reinterpret_cast<uintptr_t>(end);
}
class HandlerStack {
  public:
    HandlerStack() {
        if (stack_end == 0) stack_end = find_stack_end();
        const stack_t own{.ss_sp = memory, .ss_flags = 0, .ss_size = sizeof memory};
        sigaltstack(&own, &before_);
    }
    HandlerStack(const HandlerStack&) = delete;
    HandlerStack& operator=(const HandlerStack&) = delete;
    ~HandlerStack() { sigaltstack(&before_, nullptr); }  // a sanitizer's, which it unmaps when the thread ends

  private:
    static inline thread_local char memory[1 << 14];
    stack_t before_{};
};
void return_from_crash(int signal, siginfo_t* info, void*) {
    if (is_in_shader) {
        is_in_shader = false;
        // A stack that grows touches all of its pages (-fstack-clash-protection), those behind its end first.
        constexpr uintptr_t guard = 1 << 20;
        const uintptr_t behind = reinterpret_cast<uintptr_t>(info->si_addr) + guard;
        is_stack_full = stack_end != 0 && behind >= stack_end && behind < stack_end + 2 * guard;
        has_crashed = true;
        siglongjmp(way_back, signal);
    }
    if (has_crashed) {
        for (const char* text : {"error: the shader crashed and overwrote memory of the program, ", advice(), "\n"})
            (void)!write(STDERR_FILENO, text, std::strlen(text));
        _exit(3);
    }
    sigaction(signal, &before[signal], nullptr);
    raise(signal);
}

}  // namespace

void run_groups(RunGroup run, Bindings bindings, uint32_t count) {
    static const bool handles_crashes = [] {
        struct sigaction action {};
        action.sa_sigaction = return_from_crash;
        action.sa_flags = SA_ONSTACK | SA_SIGINFO;
        for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) sigaction(signal, &action, &before[signal]);
        return true;
    }();
    (void)handles_crashes;
    bool is_stopped = false;
    bindings.is_stopped = &is_stopped;
    bindings.group_count = count;
    const std::atomic_ref stop(is_stopped);
    // Interrupts are seen while a shader runs, since it may never end.
    const Watch watch(std::chrono::milliseconds(50), [&] {
        if (is_interrupted()) stop = true;
        return !stop;
    });
    in_parallel(count, 1, [&](size_t begin, size_t) {
        const HandlerStack stack;
        char error[512];
        const int signal = sigsetjmp(way_back, 1);
        is_in_shader = signal == 0;
        const Outcome outcome = signal == 0 ? run(bindings, static_cast<uint32_t>(begin), error, sizeof error) : Outcome::failed;
        is_in_shader = false;
        if (outcome != Outcome::failed) return;
        stop = true;
        if (signal == 0) throw DeviceFailure(error);
        if (is_stack_full)
            throw DeviceFailure(
                "the shader's arrays and other variables need more than the stack: make them smaller, or use "
                "another backend, such as --backend compute");
        throw DeviceFailure(std::string("the shader crashed (") + strsignal(signal) + "), " + advice());
    });
}

}  // namespace lab::native
#endif
