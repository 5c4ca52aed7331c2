// Renders for a long time while scenes are reloaded, cameras move and backends change: memory must stay flat, and every picture
// must be, to the bit, what it was when the program had just started. Exit code 1 if not.
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "error.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "measure/measurement.h"
#include "rendering/renderer.h"
#include "rendering/settings.h"
#include "support/chapters.h"
#include "tests/support/temporary_folder.h"

namespace lab {
namespace {

struct Case {
    std::string scene;
    std::string chapter;
};
const std::vector<Case> cases = {{"cornell_box", chapter_named("next_event_estimation")},
                                 {"textured", chapter_named("uniform_sampling")},
                                 {"glass", chapter_named("dielectrics")}};
constexpr uint32_t camera_count = 2;
constexpr uvec2 image_size(32, 32);
constexpr uint32_t samples = 2;

// For memory in use, and for resident memory: the allocator keeps some of what was freed. Mesa's CPU driver (25.0) also keeps
// some of each pipeline, 0.2 KiB for a compute shader, until its device is destroyed.
constexpr double tolerated_growth_mib = 2, tolerated_growth_per_picture_mib = 1.0 / 1024, tolerated_resident_growth_mib = 16;

// A line of /proc/self/status in MiB.
double status_mib(const std::string& name) {
    std::ifstream stream("/proc/self/status");
    for (std::string word; stream >> word;)
        if (double kibibytes = 0; word == name + ":" && stream >> kibibytes) return kibibytes / 1024;
    throw std::runtime_error("/proc/self/status does not tell " + name);
}

struct Memory {
    double used_mib;  // on the heap, and shared: the device memory of Mesa's CPU driver
    double resident_mib;
};

Memory measure_memory() {
    const auto heap = mallinfo2();
    return {static_cast<double>(heap.uordblks + heap.hblkhd) / (1 << 20) + status_mib("RssShmem"), status_mib("VmRSS")};
}

uint64_t hash_of(const FilmImage& film) {
    return hash_text({reinterpret_cast<const char*>(film.pixels.data()), film.pixels.size() * sizeof(FilmPixel)});
}

Scene load(const Case& item) { return load_scene(project_folder() / "assets" / "scenes" / (item.scene + ".json")); }

Estimator estimator_of(const Case& item) { return estimator_of(load_chapter(item.chapter)); }

void render(Renderer& renderer, uint32_t target_samples) {
    while (renderer.advance(target_samples)) {
    }
}

class Soak {
  public:
    explicit Soak(const Device& device) : device_(device) {}

    // All cases on all backends from all cameras, each loaded from its files.
    void run_round() {
        for (const Case& item : cases)
            for (const Backend backend : all_backends)
                if (device_.description().supports(backend)) run_case(item, backend);
        memory_.push_back(measure_memory());
    }

    size_t picture_count() const { return picture_count_; }
    size_t wrong_picture_count() const { return wrong_picture_count_; }
    const std::vector<Memory>& memory_after_rounds() const { return memory_; }

  private:
    void run_case(const Case& item, Backend backend) {
        Scene scene = load(item);
        const GpuScene gpu_scene(device_, scene);
        const auto acceleration_structure = build_acceleration_structure(backend, device_, gpu_scene);
        for (uint32_t camera = 0; camera < camera_count; ++camera) {
            scene.camera.position += 0.1f * (scene.camera.target - scene.camera.position);
            Renderer renderer(device_, *acceleration_structure, estimator_of(item), default_parameters(scene, image_size));
            render(renderer, samples);
            const std::string name = item.scene + " " + to_string(backend) + " " + std::to_string(camera);
            const uint64_t hash = hash_of(renderer.film().read());
            const auto [first, is_new] = first_hashes_.try_emplace(name, hash);
            ++picture_count_;
            if (first->second == hash) continue;
            ++wrong_picture_count_;
            std::fprintf(stderr, "round %zu: %s is not what it was at first\n", memory_.size() + 1, name.c_str());
        }
    }

    const Device& device_;
    std::map<std::string, uint64_t> first_hashes_;  // of the films in the first round
    std::vector<Memory> memory_;                    // at the end of each round
    size_t picture_count_ = 0, wrong_picture_count_ = 0;
};

// One film that gets a sample now and then over the whole time, and one that gets all of them at once.
class PatientFilm {
  public:
    explicit PatientFilm(const Device& device)
        : device_(device),
          scene_(load(cases.front())),
          gpu_scene_(device, scene_),
          acceleration_structure_(build_acceleration_structure(compute_backend, device, gpu_scene_)),
          renderer_(make_renderer()) {}

    void add_sample() { render(renderer_, ++sample_count_); }

    bool is_right() {
        Renderer fresh = make_renderer();
        render(fresh, sample_count_);
        return hash_of(fresh.film().read()) == hash_of(renderer_.film().read());
    }

  private:
    Renderer make_renderer() const {
        return {device_, *acceleration_structure_, estimator_of(cases.front()), default_parameters(scene_, image_size)};
    }

    const Device& device_;
    Scene scene_;
    GpuScene gpu_scene_;
    std::unique_ptr<AccelerationStructure> acceleration_structure_;
    Renderer renderer_;
    uint32_t sample_count_ = 0;
};

// Growth of a figure over all rounds: its maximum in the second half minus its value at the end of the first.
double growth(const std::vector<Memory>& rounds, double Memory::*figure) {
    const size_t middle = rounds.size() / 2;
    double largest = 0;
    for (size_t i = middle; i < rounds.size(); ++i) largest = std::max(largest, rounds[i].*figure);
    return largest - rounds[middle - 1].*figure;
}

// At most 24 rounds, evenly spaced, for the record.
json chosen(const std::vector<Memory>& rounds, double Memory::*figure) {
    auto list = json::array();
    const size_t count = std::min<size_t>(rounds.size(), 24);
    for (size_t i = 0; i < count; ++i) list.push_back(std::round(10 * rounds[i * rounds.size() / count].*figure) / 10);
    return list;
}

// Private caches: in shared ones another program may replace an entry, and the driver would compile a shader in mid-run, which
// takes memory.
class PrivateCaches {
  public:
    PrivateCaches() { setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1); }

  private:
    TemporaryFolder folder_;
};

int run(double seconds, const std::string& commit, const std::filesystem::path& record_file) {
    if (!record_file.empty()) check_writable(record_file, {".json"});
    const PrivateCaches caches;
    const Device device({.backends = all_backends});
    Soak soak(device);
    PatientFilm film(device);
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    constexpr size_t min_rounds = 4;  // so that neither half is empty
    const auto& rounds = soak.memory_after_rounds();
    while (elapsed() < seconds || rounds.size() < min_rounds) {
        soak.run_round();
        film.add_sample();
    }

    const double used_growth = growth(rounds, &Memory::used_mib);
    const double tolerated_used_growth =
        tolerated_growth_mib + static_cast<double>(soak.picture_count()) / 2 * tolerated_growth_per_picture_mib;
    const double resident_growth = growth(rounds, &Memory::resident_mib);
    const bool film_is_right = film.is_right();
    const json record = {{"commit", commit},
                         {"device", device.description().name},
                         {"seconds", std::round(elapsed())},
                         {"rounds", rounds.size()},
                         {"pictures", soak.picture_count()},
                         {"wrong_pictures", soak.wrong_picture_count()},
                         {"patient_film_is_right", film_is_right},
                         {"used_growth_mib", std::round(100 * used_growth) / 100},
                         {"tolerated_growth_mib", tolerated_used_growth},
                         {"resident_growth_mib", std::round(100 * resident_growth) / 100},
                         {"tolerated_resident_growth_mib", tolerated_resident_growth_mib},
                         {"used_mib", chosen(rounds, &Memory::used_mib)},
                         {"resident_mib", chosen(rounds, &Memory::resident_mib)}};
    std::printf("%s\n", record.dump(1).c_str());
    if (!record_file.empty()) write_file(record_file, record.dump(1) + "\n");
    const bool is_flat = used_growth <= tolerated_used_growth && resident_growth <= tolerated_resident_growth_mib;
    return soak.wrong_picture_count() == 0 && film_is_right && is_flat ? 0 : 1;
}

}  // namespace
}  // namespace lab

int main(int argument_count, char** arguments) {
    CLI::App app("Renders for a long time and checks that memory stays flat and pictures stay right", "soak");
    double seconds = 60;
    std::string commit;
    std::filesystem::path record;
    app.add_option("--seconds", seconds, "How long")->capture_default_str();
    app.add_option("--commit", commit, "For the record: what is tested");
    app.add_option("--record", record, "JSON file to write");
    return lab::run_measurement(app, argument_count, arguments, [&] { return lab::run(seconds, commit, record); });
}
