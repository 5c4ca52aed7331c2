#include "platform.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>
#include <thread>

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <windows.h>

#include <cwchar>
#else
#include <sys/resource.h>
#include <unistd.h>
#endif
#ifdef __linux__
#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <cerrno>
#endif
#ifdef __APPLE__
#include <mach-o/dyld.h>
#endif

namespace lab {

static std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

static std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal may come while it is read");

#ifdef _WIN32
static constexpr std::array ending_signals{SIGINT, SIGTERM};

static bool is_ignored(int) { return false; }

static bool repeats(int) { return false; }
#else
static constexpr std::array ending_signals{SIGINT, SIGTERM, SIGHUP, SIGXCPU};

// By the caller's wish: that of nohup, or of a script for its background jobs.
static bool is_ignored(int signal) {
    struct sigaction action {};
    return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// A terminal that closes sends SIGHUP twice, and a limit on processor time SIGXCPU each second: neither is impatience.
static bool repeats(int signal) { return signal == SIGHUP || signal == SIGXCPU; }
#endif

static void interrupt(int signal) {
    interrupted = true;
    if (!repeats(signal)) std::signal(signal, SIG_DFL);
}

void install_interrupt_handler() {
    for (const int signal : ending_signals)
        if (!is_ignored(signal)) std::signal(signal, interrupt);
}

void remove_interrupt_handler() {
    for (const int signal : ending_signals)  // one that repeats may still come, and is no reason to die before the last word
        if (!is_ignored(signal) && !repeats(signal)) std::signal(signal, SIG_DFL);
}

bool is_interrupted() { return interrupted; }

#ifdef __linux__
std::vector<WindowSystem> window_systems() {
    std::vector<WindowSystem> systems;
    // Root may inherit a user's session variables without access to its socket.
    const std::string socket = variable("WAYLAND_DISPLAY");
    std::error_code unreadable;
    if (!socket.empty() && std::filesystem::exists(std::filesystem::path(variable("XDG_RUNTIME_DIR")) / socket, unreadable))
        systems.push_back(WindowSystem::wayland);
    if (!variable("DISPLAY").empty()) systems.push_back(WindowSystem::x11);
    return systems;
}

bool would_survive(int (*step)()) {
    const pid_t child = fork();
    if (child < 0) return true;  // cannot tell
    if (child == 0) {
        const int nowhere = open("/dev/null", O_WRONLY);
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
        prctl(PR_SET_DUMPABLE, 0);      // no core file
        std::signal(SIGSEGV, SIG_DFL);  // prepare_program() may have turned a crash into an exit code
        step();
        _exit(0);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status);
}

size_t processor_count() {
    cpu_set_t processors;
    return sched_getaffinity(0, sizeof processors, &processors) == 0 ? CPU_COUNT(&processors) : 1;
}
#else
std::vector<WindowSystem> window_systems() { return {WindowSystem::other}; }

bool would_survive(int (*)()) { return true; }

size_t processor_count() { return std::thread::hardware_concurrency(); }
#endif

#ifdef _WIN32

const char* const vulkan_driver = "the newest driver of your graphics card from nvidia.com, amd.com or intel.com";

void prepare_program() {
    SetConsoleOutputCP(CP_UTF8);
    for (const DWORD stream : {STD_OUTPUT_HANDLE, STD_ERROR_HANDLE}) {
        DWORD mode = 0;
        if (GetConsoleMode(GetStdHandle(stream), &mode))
            SetConsoleMode(GetStdHandle(stream), mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    }
    DWORD process = 0;
    if (GetConsoleProcessList(&process, 1) == 1 && is_terminal(stdout))
        std::atexit([] {
            std::printf("\nThe Enter key closes this window.\n");
            std::getchar();
        });
}

bool is_terminal(std::FILE* stream) {
    DWORD mode = 0;
    return GetConsoleMode(reinterpret_cast<HANDLE>(_get_osfhandle(_fileno(stream))), &mode);
}

void make_binary(std::FILE* stream) { _setmode(_fileno(stream), _O_BINARY); }

std::filesystem::path running_program() {
    std::wstring name(32768, L'\0');  // no name is longer
    name.resize(GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size())));
    return name;
}

std::filesystem::path user_folder() { return variable("USERPROFILE"); }

int process_id() { return _getpid(); }

double processor_seconds() {
    FILETIME created, ended, kernel, user;
    GetProcessTimes(GetCurrentProcess(), &created, &ended, &kernel, &user);
    const auto seconds = [](FILETIME time) { return 1e-7 * (4294967296. * time.dwHighDateTime + time.dwLowDateTime); };
    return seconds(kernel) + seconds(user);
}

bool write_to_disk(std::FILE* stream) { return _commit(_fileno(stream)) == 0; }

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to, std::error_code& error) {
    for (int attempt = 0; attempt < 20; ++attempt) {
        std::filesystem::rename(from, to, error);
        if (error != std::errc::permission_denied) return;
        Sleep(50);
    }
}

#else

#ifdef __APPLE__
const char* const vulkan_driver = "MoltenVK (brew install vulkan-loader molten-vk)";

std::filesystem::path running_program() {
    char name[4096];
    uint32_t size = sizeof name;
    return _NSGetExecutablePath(name, &size) == 0 ? std::filesystem::weakly_canonical(name) : "";
}
#else
const char* const vulkan_driver = "libvulkan1 and a driver such as mesa-vulkan-drivers (it also has a CPU device)";

std::filesystem::path running_program() {
    std::error_code ignored;
    return std::filesystem::read_symlink("/proc/self/exe", ignored);
}
#endif

// Without memory, Mesa's drivers crash.
static void tell_limit_of_memory(int) {
    constexpr std::string_view text =
        "error: crashed, as drivers do where the limit of memory is too low: raise it (ulimit -v unlimited)\n";
    (void)!write(STDERR_FILENO, text.data(), text.size());
    _exit(3);
}

void prepare_program() {
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
    struct rlimit memory {};
    if (getrlimit(RLIMIT_AS, &memory) == 0 && memory.rlim_cur != RLIM_INFINITY) std::signal(SIGSEGV, tell_limit_of_memory);
}

void make_binary(std::FILE*) {}

bool is_terminal(std::FILE* stream) { return isatty(fileno(stream)); }

std::filesystem::path user_folder() { return variable("HOME"); }

int process_id() { return getpid(); }

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

bool write_to_disk(std::FILE* stream) { return fsync(fileno(stream)) == 0; }

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to, std::error_code& error) {
    std::filesystem::rename(from, to, error);
}

#endif

}  // namespace lab

#ifdef _WIN32
// GCC 12 converts file names with mbrtowc, which does not know UTF-8 in Microsoft's library (GCC 13 does not use it). Invalid
// bytes stand for themselves. The state holds the second half of a surrogate pair.
extern "C" size_t __wrap_mbrtowc(wchar_t* result, const char* text, size_t size, mbstate_t* state) {
    wchar_t characters[2];
    if (*state != 0) {
        *result = static_cast<wchar_t>(*state);
        *state = 0;
        return 1;
    }
    const auto first = static_cast<unsigned char>(*text);
    const int bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 1;
    const int count =
        static_cast<size_t>(bytes) <= size ? MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, bytes, characters, 2) : 0;
    *result = count > 0 ? characters[0] : first;
    if (count == 2) *state = characters[1];
    return count == 0 ? 1 : static_cast<size_t>(count == 2 ? bytes - 1 : bytes) * (first != 0);
}
#endif
