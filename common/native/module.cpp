#include "native/module.h"

#ifdef _WIN32

namespace lab::native {
std::vector<std::string> missing_tools() { return {"Linux or macOS"}; }
void set_mode(Mode) {}
Mode get_mode() { return Mode::fast; }
Code load(const std::vector<uint32_t>&) { return {}; }
MakeRayTracer load_embree() { return nullptr; }
std::string ray_tracer_name() { return "the lab's own tree"; }
}  // namespace lab::native

#else
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>

#include "error.h"
#include "files/cache.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "native/translator.h"
#include "platform.h"

extern char** environ;

namespace lab::native {
namespace {

namespace fs = std::filesystem;

Mode mode = Mode::fast;

std::string wished_lanes() {
    const char* wish = std::getenv("LAB_LANES");
    return wish ? wish : "";
}

// Why no shader may run in lanes; empty if some may.
std::string why_no_lanes() {
    if (mode == Mode::checked) return "--sanitize";
    if (mode == Mode::debug) return "a debugger sees no lanes";
    if (wished_lanes() == "0") return "LAB_LANES=0";
#if defined(__x86_64__) && defined(__GLIBC__)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "" : "the CPU lacks AVX2 or FMA";
#else
    return "lanes need an x86 CPU and the GNU C library";
#endif
}

// The first of the usual names on the PATH, or $CXX; empty if there is none.
fs::path find_compiler() {
    std::vector<std::string> names{"c++", "g++", "clang++"};
    if (const char* chosen = std::getenv("CXX"); chosen && *chosen) names.insert(names.begin(), chosen);
    const char* path = std::getenv("PATH");
    for (const std::string& name : names) {
        std::istringstream folders(path ? path : "");
        for (std::string folder; std::getline(folders, folder, ':');)
            if (access((fs::path(folder) / name).c_str(), X_OK) == 0) return fs::path(folder) / name;
    }
    return {};
}

fs::path header_folder() { return project_folder() / "common"; }

std::vector<std::string> compiler_arguments() {
    std::vector<std::string> arguments{"-std=c++20",
                                       "-shared",
                                       "-fPIC",
                                       "-fvisibility=hidden",
                                       "-fwrapv",
                                       "-fno-finite-loops",
                                       "-ffp-contract=off",
                                       "-w",
                                       "-DNDEBUG",
                                       "-fstack-clash-protection",
                                       "-I" + header_folder().string()};
    if (std::string(LAB_GLM_FOLDER) != "/usr/include") arguments.insert(arguments.end(), {"-isystem", LAB_GLM_FOLDER});
    if (mode == Mode::fast)  // in one large function, structs need not be copied from one to the next, nor to and from memory
        arguments.insert(arguments.end(), {"-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-finline-limit=4000",
                                           "--param=large-function-growth=2000", "--param=inline-unit-growth=1000",
                                           "--param=sra-max-scalarization-size-Ospeed=8192"});
    if (wished_lanes() == "8" && why_no_lanes().empty()) arguments.emplace_back("-mno-avx512f");
    if (mode == Mode::debug) arguments.insert(arguments.end(), {"-O0", "-g"});
    if (mode == Mode::checked) arguments.insert(arguments.end(), {"-O1", "-g", "-DLAB_CHECKED", "-fsanitize=undefined"});
#ifdef __linux__
    if (mode == Mode::checked) arguments.emplace_back("-lubsan");  // GCC's, as clang brings none into a library
#endif
    return arguments;
}

// The CPU, since code for one may not run on another that has the same home folder.
std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("flags") || line.starts_with("Features")) return line;
    return {};
}

// Until the end of the last one, signals that would end the program at once wait, so that compilers' files can be removed.
class EndLater {
  public:
    EndLater() {
        const std::lock_guard guard(lock);
        if (users++ != 0) return;
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
            struct sigaction before {
            }, action{};
            sigaction(signal, nullptr, &before);
            if (before.sa_handler != SIG_DFL) continue;
            action.sa_handler = [](int number) { wish = number; };
            sigaction(signal, &action, nullptr);
            changed.push_back(signal);
        }
    }
    EndLater(const EndLater&) = delete;
    EndLater& operator=(const EndLater&) = delete;
    ~EndLater() {
        const std::lock_guard guard(lock);
        if (--users != 0) return;
        for (const int signal : std::exchange(changed, {})) std::signal(signal, SIG_DFL);
        if (wish) raise(wish);
    }
    static bool is_wished() { return wish != 0; }

  private:
    static inline std::atomic<int> wish = 0;  // the signal
    static inline std::mutex lock;
    static inline int users = 0;  // threads that compile
    static inline std::vector<int> changed;
};

// Runs a program with its output in `log`. False if it fails.
bool run_program(const std::vector<std::string>& arguments, const fs::path& log) {
    std::vector<char*> pointers;
    for (const auto& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    std::vector<char*> environment;  // with messages in English
    for (char** variable = environ; *variable; ++variable)
        if (std::strncmp(*variable, "LC_ALL=", 7) != 0) environment.push_back(*variable);
    char english[] = "LC_ALL=C";
    environment.insert(environment.end(), {english, nullptr});
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    pid_t process = 0;
    int status = -1;
    const bool is_started = posix_spawn(&process, pointers[0], &actions, nullptr, pointers.data(), environment.data()) == 0;
    posix_spawn_file_actions_destroy(&actions);
    if (!is_started) return false;
    while (waitpid(process, &status, WNOHANG) == 0) {  // to wait without looking would miss a signal that came just before
        if (EndLater::is_wished()) kill(process, SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// The compiler's first error as "file:line: text".
std::string first_error(std::istream& log) {
    std::string first, line;
    while (std::getline(log, line)) {
        if (first.empty()) first = line;
        const size_t error = line.find("error: ");
        if (error != std::string::npos) return line.substr(0, line.find(':', line.find(':') + 1)) + ": " + line.substr(error + 7);
    }
    return first.empty() ? "it says nothing" : first;
}

// A new folder for a compiler's files, in the cache. Another program may compile the same, perhaps with the same process id in
// another container.
class CompilerFolder {
  public:
    explicit CompilerFolder(const fs::path& name) : path_(name.string() + "-XXXXXX") {
        std::error_code ignored;
        fs::create_directories(name.parent_path(), ignored);
        if (!mkdtemp(path_.data())) throw UserError(name.string() + ": cannot be written: " + std::strerror(errno));
    }
    CompilerFolder(const CompilerFolder&) = delete;
    CompilerFolder& operator=(const CompilerFolder&) = delete;
    ~CompilerFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    fs::path operator/(const char* file) const { return path_ / fs::path(file); }

  private:
    const EndLater until_removed_;
    std::string path_;
};

// Compiles C++ to a shared library in the cache. Returns what the compiler has against it, or nothing.
std::string compile(const std::string& text, const std::vector<std::string>& arguments, const std::string& name) try {
    const CompilerFolder folder(cache_file(name));
    write_file(folder / "code.cpp", text);
    std::vector<std::string> command{find_compiler().string(), (folder / "code.cpp").string(), "-o",
                                     (folder / "code.so").string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    if (run_program(command, folder / "log")) {
        const std::string why_not = write_cache(name, read_file(folder / "code.so", UINT64_MAX));
        if (!why_not.empty()) throw UserError(why_not);
        return "";
    }
    std::ifstream log(folder / "log");
    return command.front() + " does not compile its code: " + first_error(log);
} catch (const UserError& error) {
    throw UserError(std::string("the backend native: ") + error.what() +
                    ": make room there, or set XDG_CACHE_HOME to another folder for its code");
}

std::mutex& mutex_of(const std::string& name) {
    static std::mutex guard;
    static std::map<std::string, std::mutex> mutexes;
    const std::scoped_lock lock(guard);
    return mutexes[name];
}

// A library, from the cache if possible. If the compiler refuses it, the result is null and `refusal` says why.
void* load_library(const std::string& text, const std::vector<std::string>& arguments, std::string& refusal) {
    std::string key = find_compiler().string() + processor() + text;
    for (const auto& argument : arguments) key += " " + argument;
    for (const char* header : {"glsl.h", "bindings.h", "embree.h", "lanes/lanes.h", "lanes/statements.h", "lanes/builtins.h",
                               "lanes/vectors.h", "lanes/packet.h", "lanes/few_triangles.h"})
        key += read_file(header_folder() / "native" / header, UINT64_MAX);
    const std::string name = cache_name("native", key);
    const fs::path file = cache_file(name);
    {
        const std::scoped_lock lock(mutex_of(name));  // of two threads that want the same, one waits for what the other compiles
        if (!read_cache(name)) refusal = compile(text, arguments, name);
    }
    if (!refusal.empty()) return nullptr;
    void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library) return library;
    const std::string reason = dlerror();
    std::error_code ignored;
    fs::remove(file, ignored);  // a compiler may have written something else
    throw UserError("the backend native cannot load its code: " + reason +
                    ": set XDG_CACHE_HOME to a folder that allows programs");
}

// The library of a text for lanes if possible, or else of one without; then `why_one_by_one` says why.
void* load_library(const std::function<std::string(bool)>& text, const std::vector<std::string>& arguments,
                   const std::vector<std::string>& lane_arguments, std::string& why_one_by_one) {
    why_one_by_one = why_no_lanes();
    if (why_one_by_one.empty()) {
        auto all = arguments;
        all.insert(all.end(), lane_arguments.begin(), lane_arguments.end());
        if (void* library = load_library(text(true), all, why_one_by_one)) return library;
    }
    std::string refusal;
    if (void* library = load_library(text(false), arguments, refusal)) return library;
    throw UserError("the backend native: " + refusal + ": use another backend, such as --backend compute");
}

// The library "embree4" or "embree3" if one can compile with it: its name without a version is there if its headers are. Empty if
// there is none, or if LAB_WITHOUT_EMBREE is in the environment.
std::string find_embree() {
    if (std::getenv("LAB_WITHOUT_EMBREE")) return {};
    for (const std::string name : {"embree4", "embree3"})
        if (dlopen(("lib" + name + ".so").c_str(), RTLD_LAZY | RTLD_LOCAL)) return name;
    return {};
}

}  // namespace

std::vector<std::string> missing_tools() {
    std::vector<std::string> missing;
    if (std::getenv("LAB_WITHOUT_NATIVE")) missing.emplace_back("a permission: LAB_WITHOUT_NATIVE forbids it");
    if (cache_file("").empty()) missing.emplace_back("a folder for its code (XDG_CACHE_HOME)");
    if (find_compiler().empty()) missing.emplace_back("a C++ compiler (c++)");
    if (!fs::exists(header_folder() / "native/glsl.h")) missing.emplace_back("the lab's sources (common/)");
    if (!fs::exists(fs::path(LAB_GLM_FOLDER) / "glm/glm.hpp")) missing.emplace_back("the headers of GLM (libglm-dev)");
    return missing;
}

void set_mode(Mode wanted) { mode = wanted; }
Mode get_mode() { return mode; }

Code load(const std::vector<uint32_t>& spirv) {
    std::string why_one_by_one;
    void* library = load_library([&](bool for_lanes) { return translate(spirv, for_lanes); }, compiler_arguments(),
                                 // GCC 12 crashes where it tries to make vectors of vectors
                                 {"-fno-tree-vectorize", "-lmvec", "-Wl,-z,defs"}, why_one_by_one);
    return {reinterpret_cast<RunGroup>(dlsym(library, "lab_run_group")),
            *static_cast<const int*>(dlsym(library, "lab_invocations_at_once")), why_one_by_one};
}

MakeRayTracer load_embree() {
    const std::string embree = find_embree();
    if (embree.empty()) return nullptr;
    auto arguments = compiler_arguments();
    arguments.push_back("-l" + embree);
    const std::string text = "#include <" + embree + "/rtcore.h>\n#include \"native/lanes/few_triangles.h\"\n";
    std::string why_one_by_one;
    void* library = load_library([&](bool) { return text; }, arguments, {"-DLAB_FEW_TRIANGLES"}, why_one_by_one);
    return reinterpret_cast<MakeRayTracer>(dlsym(library, "lab_make_ray_tracer"));
}

std::string ray_tracer_name() {
    const std::string embree = find_embree();
    return embree.empty() ? "the lab's own tree; libembree-dev is faster" : "Embree " + embree.substr(embree.size() - 1);
}

}  // namespace lab::native
#endif
