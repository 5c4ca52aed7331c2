#include "hostile_input.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "error.h"
#include "files/file.h"
#include "scene/features.h"
#include "scene/light_table.h"
#include "tests/support/temporary_folder.h"
#include "tracing/bvh.h"

// From the sanitizers' run-time library; GCC does not ship the header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, size_t),
                                                         void (*on_free)(const volatile void*));

namespace lab {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void report_defect(const std::string& what) {
    std::fprintf(stderr, "defect: %s\n", what.c_str());
    std::abort();
}

void require(bool condition, const char* what) {
    if (!condition) report_defect(what);
}

// Largest single allocation allowed while reading an input; 0 between inputs.
std::atomic<size_t> allocation_limit = 0;

void check_allocation(const volatile void*, size_t size) {
    const size_t limit = allocation_limit;
    if (limit == 0 || size <= limit) return;
    allocation_limit = 0;
    report_defect("an allocation of " + std::to_string(size) + " bytes");
}

// A folder in memory that contains the seeds of all formats for an input to refer to; removed at the end.
class Folder {
  public:
    Folder() : folder_(fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) {
        for (const auto& seed : fs::recursive_directory_iterator(LAB_FUZZ_SEEDS))
            if (seed.is_regular_file()) fs::copy_file(seed.path(), folder_.path() / seed.path().filename());
    }

    fs::path write(const char* name, const uint8_t* bytes, size_t size) const {
        std::ofstream(folder_.path() / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
        return folder_.path() / name;
    }

  private:
    TemporaryFolder folder_;
};

bool is_printable_line(const std::string& text) {
    return !text.empty() && text.size() < 2500 &&
           std::none_of(text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c); });
}

}  // namespace

void use_scene(const Scene& scene) {
    for (const uvec3& triangle : scene.triangles)
        for (int corner = 0; corner < 3; ++corner)
            require(triangle[corner] < scene.positions.size(), "a vertex index out of range");
    for (const uint32_t material : scene.triangle_materials)
        require(material < scene.materials.size(), "a material index out of range");
    for (const Material& material : scene.materials)
        require(material.albedo_texture < static_cast<int>(scene.textures.size()), "a texture index out of range");
    for (const uint32_t mesh : scene.instance_meshes) require(mesh < scene.meshes.size(), "a mesh index out of range");
    require(scene.triangle_materials.size() == scene.triangles.size(), "triangles without a material");
    require(scene.normals.empty() || scene.normals.size() == scene.positions.size(), "vertices without a normal");
    require(scene.texture_coordinates.empty() || scene.texture_coordinates.size() == scene.positions.size(),
            "vertices without texture coordinates");
    for (const std::string& warning : scene.warnings)
        require(is_printable_line(warning), "a warning that is not one printable line");

    make_camera(scene.camera, scene.defaults.width, scene.defaults.height);
    if (features_of(scene).area_lights) build_light_table(scene);
    build_bvh(world_triangles(scene));
}

}  // namespace lab

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
    static const lab::Folder folder;
    static const int installed = __sanitizer_install_malloc_and_free_hooks(lab::check_allocation, [](const volatile void*) {});
    lab::require(installed != 0, "allocations cannot be watched");

    const auto file = folder.write(lab::hostile_file_name, bytes, size);
    lab::allocation_limit = lab::memory_limit(size);
    try {
        lab::read_hostile_file(file);
    } catch (const lab::UserError& error) {
        lab::require(lab::is_printable_line(error.what()), error.what());
    } catch (const std::exception& error) {
        lab::report_defect(std::string("not a UserError: ") + error.what());
    }
    lab::allocation_limit = 0;
    return 0;
}
