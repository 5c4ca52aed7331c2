#include "rendering/interrupt.h"

#include <csignal>

namespace lab {
namespace {

volatile std::sig_atomic_t interrupted = 0;

}  // namespace

void install_interrupt_handler() {
    const auto handler = [](int signal) {
        interrupted = 1;
        std::signal(signal, SIG_DFL);
    };
    std::signal(SIGINT, handler);
    std::signal(SIGTERM, handler);
}

bool is_interrupted() { return interrupted != 0; }

}  // namespace lab
