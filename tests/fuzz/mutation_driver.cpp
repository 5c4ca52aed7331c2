// Runs a fuzz target without libFuzzer, which needs Clang: mutates inputs at random and keeps those that reach new code. Takes
// libFuzzer's arguments: [-max_total_time=SECONDS] [-seed=N] FILE_OR_FOLDER...
#include <sanitizer/common_interface_defs.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "hostile_input.h"

namespace {

using Input = std::vector<uint8_t>;

constexpr size_t max_input_bytes = 1 << 14;
constexpr int max_cpu_seconds_an_input = 5;

// Basic blocks of the loaders that were reached, by a hash of their address.
std::bitset<1 << 20> reached;
bool reached_more = false;

const Input* current = nullptr;

// Saves the input that crashed the program.
void save_current_input() {
    if (!current) return;
    const std::string name = std::string("crash_") + lab::hostile_file_name;
    std::ofstream(name, std::ios::binary)
        .write(reinterpret_cast<const char*>(current->data()), static_cast<std::streamsize>(current->size()));
    std::fprintf(stderr, "the input is kept in %s: name it as argument to see this again\n", name.c_str());
}

void stop_hanging_input(int) {
    std::fprintf(stderr, "defect: an input took more than %d s\n", max_cpu_seconds_an_input);
    std::abort();
}

void run(const Input& input) {
    const itimerval limit{{}, {max_cpu_seconds_an_input, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    current = &input;
    reached_more = false;
    LLVMFuzzerTestOneInput(input.data(), input.size());
    current = nullptr;
}

class Mutator {
  public:
    explicit Mutator(uint32_t seed) : random_(seed) {}

    // Copies one input and makes up to eight changes.
    Input make(const std::vector<Input>& corpus) {
        Input input = corpus[below(corpus.size())];
        for (size_t changes = 1 + below(8); changes > 0; --changes) change(input, corpus[below(corpus.size())]);
        input.resize(std::min(input.size(), max_input_bytes));
        return input;
    }

  private:
    size_t below(size_t bound) { return std::uniform_int_distribution<size_t>(0, bound - 1)(random_); }

    void change(Input& input, const Input& other) {
        static constexpr std::array<uint8_t, 12> telling_bytes{0, 1, 127, 128, 255, '0', '9', '-', ' ', '\n', '/', '.'};
        if (input.empty()) input.push_back(0);
        const auto at = [&](size_t i) { return input.begin() + static_cast<std::ptrdiff_t>(i); };
        const size_t start = below(input.size());
        const size_t length = 1 + below(std::min<size_t>(input.size() - start, 64));
        switch (below(7)) {
            case 0:
                input[start] ^= static_cast<uint8_t>(1u << below(8));
                break;
            case 1:
                input[start] = telling_bytes[below(telling_bytes.size())];
                break;
            case 2:
                input[start] = static_cast<uint8_t>(below(256));
                break;
            case 3:
                input.erase(at(start), at(start + length));
                break;
            case 4: {
                const Input copy(at(start), at(start + length));
                input.insert(at(below(input.size())), copy.begin(), copy.end());
                break;
            }
            case 5: {
                if (other.empty()) break;
                const auto from = other.begin() + static_cast<std::ptrdiff_t>(below(other.size()));
                const auto count = std::min<std::ptrdiff_t>(other.end() - from, static_cast<std::ptrdiff_t>(length));
                const Input part(from, from + count);
                input.insert(at(start), part.begin(), part.end());
                break;
            }
            default:
                input.resize(start);
        }
    }

    std::mt19937 random_;
};

std::vector<Input> read_inputs(const std::filesystem::path& path) {
    std::vector<std::filesystem::path> files;
    if (std::filesystem::is_directory(path))
        for (const auto& entry : std::filesystem::directory_iterator(path)) files.push_back(entry.path());
    else
        files.push_back(path);
    std::sort(files.begin(), files.end());
    std::vector<Input> inputs;
    for (const auto& file : files) {
        std::ifstream stream(file, std::ios::binary);
        inputs.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
    return inputs;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

// Makes the run-time library catch abort() as well, so that the input is saved then, too.
extern "C" const char* __asan_default_options() { return "handle_abort=1"; }

// GCC inserts a call of this at the start of each basic block of the loaders.
extern "C" void __sanitizer_cov_trace_pc() {
    const auto address = reinterpret_cast<uintptr_t>(__builtin_return_address(0));
    const size_t slot = address * 0x9e3779b97f4a7c15u >> 44;
    if (reached[slot]) return;
    reached[slot] = true;
    reached_more = true;
}

int main(int argument_count, char** arguments) {
    double seconds = 0;
    uint32_t seed = 1;
    std::vector<Input> corpus;
    for (int i = 1; i < argument_count; ++i) {
        const std::string argument = arguments[i];
        if (argument.starts_with("-max_total_time="))
            seconds = std::stod(argument.substr(16));
        else if (argument.starts_with("-seed="))
            seed = static_cast<uint32_t>(std::stoul(argument.substr(6)));
        else
            for (Input& input : read_inputs(argument)) corpus.push_back(std::move(input));
    }
    if (corpus.empty()) {
        std::fprintf(stderr, "name a file or a folder of files to start from\n");
        return 1;
    }

    __sanitizer_set_death_callback(save_current_input);
    std::signal(SIGPROF, stop_hanging_input);
    for (const Input& input : corpus) run(input);
    Mutator mutator(seed);
    size_t executions = corpus.size();
    const double start = cpu_seconds();
    for (; cpu_seconds() - start < seconds; ++executions) {
        const Input input = mutator.make(corpus);
        run(input);
        if (reached_more) corpus.push_back(input);
    }
    std::printf("%zu inputs, %zu kept, %zu blocks reached\n", executions, corpus.size(), reached.count());
    return 0;
}
