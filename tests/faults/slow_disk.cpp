// Preload this to make each renaming of a file take half a second, as if the disk were slow. Their beginnings and ends, in
// seconds of the monotonic clock, and their files go to the file that SLOW_DISK_LOG names.
#include <dlfcn.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace {
double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
}  // namespace

extern "C" int rename(const char* from, const char* to) noexcept {
    const double begin = now();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const auto real = reinterpret_cast<int (*)(const char*, const char*)>(dlsym(RTLD_NEXT, "rename"));
    const int result = real(from, to);
    if (FILE* log = std::fopen(std::getenv("SLOW_DISK_LOG"), "a")) {
        std::fprintf(log, "%.6f %.6f %s\n", begin, now(), to);
        std::fclose(log);
    }
    return result;
}
