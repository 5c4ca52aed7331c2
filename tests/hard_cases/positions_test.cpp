// The same scene in other places and at other scales.
#include <cmath>

#include "hard_cases/probe.h"
#include "scene/warnings.h"
#include "support/expect_statistics.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;

class Positions : public OnEachBackend {
  protected:
    Batches batches(const Scene& scene) const {
        return render_batches(scene,
                              {.width = 32,
                               .height = 32,
                               .samples = 8,
                               .max_path_length = 3,
                               .seed = 1,
                               .estimator = chapter_estimator(chapter_named("next_event_estimation")),
                               .backend = GetParam()},
                              32);
    }
    // What drivers do is measured. Our code goes as far as areas and volumes fit into 32 bits.
    static bool is_of_a_driver() { return GetParam() == pipeline_backend || GetParam() == query_backend; }
};
INSTANTIATE_TEST_SUITE_P(Backends, Positions, testing::ValuesIn(all_backends), own_backend_name);

Scene cornell_box() { return load_shipped_scene("cornell_box.json"); }

// Scales and then moves instance and camera, as the keys of a scene file do.
Scene place(Scene scene, double scale, const dvec3& translation) {
    const auto linear = static_cast<float>(scale);
    mat4x3 transform(linear);
    transform[3] = vec3(translation);
    set_transform(scene, transform);
    const auto image_of = [&](const vec3& point) { return vec3(scale * dvec3(point) + translation); };
    scene.camera.position = image_of(scene.camera.position);
    scene.camera.target = image_of(scene.camera.target);
    return scene;
}

// The means of the image and its tiles relative to the image's mean: in each batch the same random numbers give the same paths,
// so noise cancels.
struct Deviation {
    std::vector<Difference> image, tiles;
    double worst_tile() const {
        double worst = 0;
        for (const Difference& tile : tiles)
            if (std::abs(tile.value) > std::abs(worst)) worst = tile.value;
        return worst;
    }
};

Deviation deviation(const Batches& moved, const Batches& original) {
    const double mean = estimate_mean(original.means(1)).mean;
    const auto difference = [&](uvec2 corner, uvec2 size) {
        std::vector<double> differences = moved.means(1, corner, size);
        const std::vector<double> expected = original.means(1, corner, size);
        for (size_t i = 0; i < expected.size(); ++i) differences[i] = (differences[i] - expected[i]) / mean;
        Difference result = difference_from(differences, 0);
        // Rounding shifts the view: without noise even 10^-5 of it would show.
        result.standard_error = std::max(result.standard_error, 2e-5);
        return result;
    };
    Deviation result;
    result.image.push_back(difference({0, 0}, {original.width, original.height}));
    for (uint32_t y = 0; y < original.height; y += 8)
        for (uint32_t x = 0; x < original.width; x += 8) result.tiles.push_back(difference({x, y}, {8, 8}));
    return result;
}

void expect_no_deviation(const std::string& what, const Deviation& deviation, size_t comparisons) {
    expect_no_difference(what + ", image", deviation.image, 0.01, 2 * comparisons);
    expect_no_difference(what + ", tiles", deviation.tiles, 0.05, 2 * comparisons);
}

TEST_P(Positions, FarFromTheOriginThePictureIsTheSameOrTheLoaderWarns_all) {
    const Scene original = cornell_box();
    ASSERT_TRUE(precision_warnings(original).empty());
    const Batches expected = batches(original);
    for (const double distance : {1e2, 1e3, 1e4, 1e5, 1e6}) {
        const Scene moved = place(original, 1, distance * dvec3(1, 0.3, -0.7));
        const Deviation bias = deviation(batches(moved), expected);
        const bool has_warning = !precision_warnings(moved).empty();
        RecordProperty("bias_at_1e" + std::to_string(std::lround(std::log10(distance))),
                       "image " + percent(bias.image.front().value) + ", worst tile " + percent(bias.worst_tile()) +
                           (has_warning ? ", warned" : ""));
        if (!has_warning) expect_no_deviation("moved by " + std::to_string(distance), bias, 5);
    }
}

TEST_P(Positions, SizeDoesNotMatter_all) {
    const Scene original = cornell_box();
    const Batches expected = batches(original);
    std::vector<double> scales{1e-6, 1e-3, 1e3, 1e6};
    if (!is_of_a_driver()) scales.insert(scales.end(), {1e-15, 1e-9, 1e12, 1e15});
    for (const double scale : scales) {
        const Scene scaled = place(original, scale, dvec3(0));
        EXPECT_TRUE(precision_warnings(scaled).empty());
        const Deviation bias = deviation(batches(scaled), expected);
        RecordProperty("bias_at_1e" + std::to_string(std::lround(std::log10(scale))),
                       "image " + percent(bias.image.front().value) + ", worst tile " + percent(bias.worst_tile()));
        expect_no_deviation("scaled by " + std::to_string(scale), bias, scales.size());
    }
}

// Scaling by a power of two keeps all digits: the picture is the same to the bit, unless something has an absolute scale,
// overflows or underflows.
TEST_P(Positions, PowersOfTwoChangeNoBit) {
    const auto render_scaled = [&](const std::string& file, int exponent) {
        Scene scene = load_shipped_scene(file);
        const float scale = std::ldexp(1.0f, exponent);
        for (vec3& position : scene.positions) position *= scale;
        for (Instance& instance : scene.instances) instance.object_to_world[3] *= scale;
        scene.camera.position *= scale;
        scene.camera.target *= scale;
        return render(scene, {.width = 32,
                              .height = 32,
                              .samples = 4,
                              .estimator = chapter_estimator(chapter_named("dielectrics")),
                              .backend = GetParam()});
    };
    std::vector<std::string> files{"cornell_box.json"};
    if (!is_of_a_driver()) files.emplace_back("torus.json");  // of small triangles
    std::vector<FilmImage> expected;
    for (const std::string& file : files) expected.push_back(render_scaled(file, 0));
    const auto is_same = [&](int exponent) {
        size_t different = 0;
        for (size_t scene = 0; scene < files.size(); ++scene) {
            const FilmImage scaled = render_scaled(files[scene], exponent);
            for (size_t i = 0; i < scaled.pixels.size(); ++i) different += scaled.pixels[i].sum != expected[scene].pixels[i].sum;
        }
        std::printf("  2^%d: %zu pixels differ\n", exponent, different);
        return different == 0;
    };
    const int certain = is_of_a_driver() ? 20 : 50;
    for (const int exponent : {-certain, -10, 10, certain}) EXPECT_TRUE(is_same(exponent)) << "2^" << exponent;
    int lowest = -certain, highest = certain;
    while (lowest > -60 && is_same(lowest - 10)) lowest -= 10;
    while (highest < 50 && is_same(highest + 10)) highest += 10;
    RecordProperty("same_to_the_bit", "2^" + std::to_string(lowest) + " to 2^" + std::to_string(highest));
}

}  // namespace
}  // namespace lab
