#include "support/device_arithmetic.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "files/project_folder.h"
#include "support/bounce.h"
#include "support/gpu_test.h"
#include "support/hemisphere.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

constexpr double unlimited = std::numeric_limits<double>::infinity();

// The spacing of floats at a number.
double ulp_of(double number) {
    const int exponent = std::max(std::ilogb(number), std::numeric_limits<float>::min_exponent - 1);
    return std::ldexp(1.0, exponent - 23);
}

// A function of one or two numbers: in GLSL, in double, the range to examine, and the allowed error.
struct Function {
    const char* name;
    const char* glsl;
    const char* range;
    const char* guaranteed;
    double (*exact)(double x, double y);
    vec2 (*arguments)(double u, double v);  // for u and v in [0,1]
    double (*allowed)(double x, double y, double exact);
    bool has_results_of_all_sizes = false;
};

double log_uniform(double u, double low, double high) { return low * std::pow(high / low, u); }
double nothing_allowed(double, double, double) { return unlimited; }
double sine_allowed(double, double, double) { return 0x1p-11; }
vec2 angle(double u, double) { return {(2 * u - 1) * pi, 0}; }

// pow(x, y) inherits its error from exp2(y log2(x)).
double pow_allowed(double x, double y, double exact) {
    const double exponent = y * std::log2(x);
    const double logarithm_error = x >= 0.5 && x <= 2 ? 0x1p-21 : 3 * ulp_of(std::log2(x));
    return (3 + 2 * std::abs(exponent)) * ulp_of(exact) +
           exact * (std::exp2(y * logarithm_error + std::abs(exponent) * 0x1p-23) - 1);
}

const Function functions[] = {
    {"sin(x)", "sin(x)", "x in [-pi, pi]", "2^-11 = 4.9e-4 absolute", [](double x, double) { return std::sin(x); }, angle,
     sine_allowed},
    {"cos(x)", "cos(x)", "x in [-pi, pi]", "2^-11 = 4.9e-4 absolute", [](double x, double) { return std::cos(x); }, angle,
     sine_allowed},
    {"sqrt(x)", "sqrt(x)", "x in [1e-12, 1e12]", "that of 1 / inversesqrt: 6.5 ulp",
     [](double x, double) { return std::sqrt(x); }, [](double u, double) { return vec2(log_uniform(u, 1e-12, 1e12), 0); },
     [](double, double, double exact) { return 6.5 * ulp_of(exact); }, true},
    {"inversesqrt(x)", "inversesqrt(x)", "x in [1e-12, 1e12]", "2 ulp", [](double x, double) { return 1 / std::sqrt(x); },
     [](double u, double) { return vec2(log_uniform(u, 1e-12, 1e12), 0); },
     [](double, double, double exact) { return 2 * ulp_of(exact); }, true},
    {"x / y", "((x) / (y))", "x, y in [1e-12, 1e12]", "2.5 ulp", [](double x, double y) { return x / y; },
     [](double u, double v) { return vec2(log_uniform(u, 1e-12, 1e12), log_uniform(v, 1e-12, 1e12)); },
     [](double, double, double exact) { return 2.5 * ulp_of(exact); }, true},
    {"atan(x, y)", "atan(x, y)", "all directions (light probe)", "4096 ulp", [](double x, double y) { return std::atan2(x, y); },
     [](double u, double v) {
         const double length = log_uniform(v, 1e-6, 1), phi = (2 * u - 1) * pi;
         return vec2(length * std::sin(phi), length * std::cos(phi));
     },
     [](double, double, double exact) { return 4096 * ulp_of(exact); }},
    {"acos(x)", "acos(x)", "x in [-1, 1] (light probe)", "-", [](double x, double) { return std::acos(x); },
     [](double u, double v) { return vec2(v < 0.5 ? 2 * u - 1 : 1 - log_uniform(u, 1e-7, 1), 0); }, nothing_allowed},
    {"exp(x)", "exp(x)", "x in [-80, -1e-6] (absorption)", "3 + 2 |x| ulp", [](double x, double) { return std::exp(x); },
     [](double u, double) { return vec2(-log_uniform(u, 1e-6, 80), 0); },
     [](double x, double, double exact) { return (3 + 2 * std::abs(x)) * ulp_of(exact); }},
    {"pow(x, 2.4)", "pow(x, 2.4)", "x in [0.09, 1] (textures)", "that of exp2(y log2(x))",
     [](double x, double) { return std::pow(x, double{2.4f}); }, [](double u, double) { return vec2(0.09 + 0.91 * u, 0); },
     [](double x, double, double exact) { return pow_allowed(x, double{2.4f}, exact); }},
    {"pow(x, y)", "pow(x, y)", "y in [1, 1000], x^y in [1e-12, 1] (Phong lobe)", "that of exp2(y log2(x))",
     [](double x, double y) { return std::pow(x, y); },
     [](double u, double v) {
         const double exponent = log_uniform(v, 1, 1000);
         return vec2(std::pow(log_uniform(u, 1e-12, 1), 1 / exponent), exponent);
     },
     pow_allowed},
    {"normalize(x, y, 1).x", "normalize(vec3(x, y, 1.0))[0]", "|x|, |y| in [1e-3, 1e3]", "-",
     [](double x, double y) { return x / std::sqrt(x * x + y * y + 1); },
     [](double u, double v) { return vec2(log_uniform(u, 1e-3, 1e3), log_uniform(v, 1e-3, 1e3)); }, nothing_allowed},
};

FunctionError measure(const Device& device, const Function& function, size_t count) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<vec2> arguments;
    for (const double u : {0.0, 0.5, 1.0})
        for (const double v : {0.0, 0.25, 1.0}) arguments.push_back(function.arguments(u, v));
    while (arguments.size() < count) arguments.push_back(function.arguments(uniform(generator), uniform(generator)));
    const TestShader shader{.name = "device_arithmetic.comp", .defines = {std::string("FUNCTION(x, y) ") + function.glsl}};
    const auto results = run_shader<float>(shader, arguments, device);
    FunctionError worst{function.name, function.range, function.guaranteed};
    double largest = 0;
    for (size_t i = 0; i < results.size(); ++i) {
        const double x = arguments[i].x, y = arguments[i].y, exact = function.exact(x, y);
        // A result that is not a number is infinitely wrong.
        const double error = std::isfinite(results[i]) ? std::abs(results[i] - exact) : unlimited;
        largest = std::max(largest, error);
        worst.ulps = std::max(worst.ulps, error / ulp_of(exact));
        worst.share_of_guarantee = std::max(worst.share_of_guarantee, error / function.allowed(x, y, exact));
    }
    if (!function.has_results_of_all_sizes) worst.absolute = largest;
    return worst;
}

// Pairs of numbers that the generator can return: the corners of the square, and a grid.
std::vector<std::array<double, 2>> random_numbers() {
    constexpr double below_one = 1 - 0x1p-24;
    std::vector<std::array<double, 2>> numbers;
    for (const double x : {0.0, 0x1p-24, 0.25, 0.5, 0.75, below_one})
        for (const double y : {0.0, 0x1p-24, 0x1p-12, 0.5, 1 - 0x1p-12, 1 - 0x1p-23}) numbers.push_back({x, y});
    for (int x = 0; x < 512; ++x)
        for (int y = 0; y < 512; ++y) numbers.push_back({(x + 0.5) / 512, (y + 0.5) / 512});
    return numbers;
}

dvec3 direction(double cos_theta, double sin_theta, double phi) {
    return {std::cos(phi) * sin_theta, std::sin(phi) * sin_theta, cos_theta};
}

double uniform_angles_error(const Device& device) {
    const auto numbers = random_numbers();
    const auto bounces = bounces_at(chapter_named("uniform_sampling"), {{0, 0, 1}, {0, 0, 1}, white_material()}, numbers, device);
    double worst = 0;
    for (size_t i = 0; i < numbers.size(); ++i) {
        const double phi = 2 * pi * numbers[i][0] - pi, theta = 0.5 * pi * numbers[i][1];
        if (bounces[i].ray_count != 2) continue;  // rejected, since it lies along the surface
        worst = std::max(worst, glm::distance(dvec3(bounces[i].direction), direction(std::cos(theta), std::sin(theta), phi)));
    }
    return worst;
}

double cosine_sampling_error(const Device& device) {
    std::vector<vec2> numbers;
    for (const auto& [x, y] : random_numbers()) numbers.emplace_back(x, y);
    const auto directions = sample_hemisphere(chapter_named("cosine_sampling"), numbers, device);
    double worst = 0;
    for (size_t i = 0; i < numbers.size(); ++i) {
        const double phi = 2 * pi * numbers[i].x - pi, y = numbers[i].y;
        worst = std::max(worst, glm::distance(dvec3(directions[i]), direction(std::sqrt(1 - y), std::sqrt(y), phi)));
    }
    return worst;
}

double light_point_error(const Device& device) {
    const LightTriangle light{.instance = 0, .triangle = 1, .threshold = 0, .alias = 0, .inverse_density = 1};
    const auto numbers = random_numbers();
    std::vector<std::byte> inputs;
    const auto append = [&](std::span<const std::byte> bytes) { inputs.insert(inputs.end(), bytes.begin(), bytes.end()); };
    append(std::as_bytes(std::span(&light, 1)));
    // Choosing the light takes one step of the generator.
    for (const auto& u : numbers) {
        const RandomState state = previous_state(state_before(u));
        append(std::as_bytes(std::span(state)));
    }
    TestShader shader{.name = "light_point.comp"};
    shader.named_includes = {{"path_trace.glsl", project_folder() / "chapters/03_next_event_estimation/path_trace.glsl"}};
    std::vector<vec2> points(numbers.size());
    run_shader(shader, points.size(), std::as_writable_bytes(std::span(points)), inputs, device);
    double worst = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const auto& [x, y] = numbers[i];
        const glm::dvec2 expected(std::sqrt(x) * (1 - y), std::sqrt(x) * y);
        worst = std::max(worst, glm::distance(glm::dvec2(points[i]), expected));
    }
    return worst;
}

// The outputs of hit_point.glsl for every pixel, with one sample each.
struct HitPoints {
    std::vector<vec3> directions, positions, ids;
};

HitPoints trace(const Device& device, const Scene& scene, Backend backend) {
    const GpuScene gpu_scene(device, scene);
    const auto scene_backend = backend->build(device, gpu_scene);
    HitPoints points;
    std::vector<vec3>* const results[] = {&points.directions, &points.positions, &points.ids};
    for (uint32_t which = 0; which < std::size(results); ++which) {
        RenderParameters parameters = default_parameters(scene, uvec2(256));
        parameters.max_path_length = which;
        Renderer renderer(device, *scene_backend, {project_folder() / "tests/shaders/hit_point.glsl"}, parameters);
        while (renderer.advance(1)) {
        }
        for (const FilmPixel& pixel : renderer.film().read().pixels) results[which]->push_back(pixel.sum);
    }
    return points;
}

HitPointError hit_point_error(const Device& device, const std::string& name, const Scene& scene, Backend backend) {
    const HitPoints points = trace(device, scene, backend);
    HitPointError worst{backend, name};
    const dvec3 origin(scene.camera.position);
    for (size_t i = 0; i < points.ids.size(); ++i) {
        if (points.ids[i].x < 0) continue;
        const Instance& instance = scene.instances[static_cast<size_t>(points.ids[i].x)];
        const uvec3 corners = scene.triangles[static_cast<size_t>(points.ids[i].y)];
        const auto world = [&](uint32_t corner) {
            return glm::dmat4x3(instance.object_to_world) * glm::dvec4(scene.positions[corner], 1);
        };
        const dvec3 x_0 = world(corners.x);
        const dvec3 normal = glm::normalize(glm::cross(world(corners.y) - x_0, world(corners.z) - x_0));
        const dvec3 found(points.positions[i]), ray(points.directions[i]);
        const double distance = glm::dot(x_0 - origin, normal) / glm::dot(ray, normal);
        const double off_plane = std::abs(glm::dot(found - x_0, normal));
        const double off_ray = glm::length(glm::cross(found - origin, glm::normalize(ray)));
        worst.off_plane = std::max(worst.off_plane, off_plane / double{points.ids[i].z});
        worst.off_ray = std::max(worst.off_ray, off_ray / (distance * glm::length(ray)));
    }
    return worst;
}

// The scene rotated, scaled and moved as an instance, and the camera with it.
Scene placed(Scene scene, const mat3& linear, const vec3& translation) {
    set_transform(scene, mat4x3(linear[0], linear[1], linear[2], translation));
    scene.camera.position = linear * scene.camera.position + translation;
    scene.camera.target = linear * scene.camera.target + translation;
    scene.camera.up = linear * scene.camera.up;
    return scene;
}

}  // namespace

std::vector<FunctionError> measure_functions(const Device& device, size_t count) {
    std::vector<FunctionError> errors;
    for (const Function& function : functions) errors.push_back(measure(device, function, count));
    return errors;
}

std::vector<SamplerError> measure_samplers(const Device& device) {
    return {{"uniform angles (chapter 1)", uniform_angles_error(device)},
            {"cosine (chapter 2)", cosine_sampling_error(device)},
            {"point on a triangle (chapter 3)", light_point_error(device)}};
}

std::vector<HitPointError> measure_hit_points(const Device& device) {
    const Scene box = load_shipped_scene("cornell_box.json");
    const mat3 turn{{0.36f, 0.48f, -0.8f}, {-0.8f, 0.6f, 0}, {0.48f, 0.64f, 0.6f}};
    const std::pair<const char*, Scene> scenes[] = {
        {"Cornell box", box}, {"turned, three times as large, 30 away", placed(box, 3.0f * turn, {10, -20, 20})}};
    std::vector<HitPointError> errors;
    for (const Backend backend : all_backends)
        for (const auto& [name, scene] : scenes)
            if (is_supported(backend, device.description())) errors.push_back(hit_point_error(device, name, scene, backend));
    return errors;
}

const Arithmetic& test_arithmetic() {
    static const Arithmetic measured = [] {
        // Every test program pays for this; tolerances are multiples of these errors.
        constexpr size_t count = 1 << 15;
        const auto error_of = [errors = measure_functions(test_device(), count)](const std::string& name) {
            return *std::find_if(errors.begin(), errors.end(), [&](const FunctionError& error) { return error.name == name; });
        };
        return Arithmetic{
            .sine = std::max(*error_of("sin(x)").absolute, *error_of("cos(x)").absolute),
            .decoding = error_of("pow(x, 2.4)").ulps * 0x1p-23,
            .phong_lobe = error_of("pow(x, y)").ulps * 0x1p-23,
            .division = std::max({error_of("x / y").ulps, error_of("sqrt(x)").ulps, error_of("inversesqrt(x)").ulps}) * 0x1p-23};
    }();
    return measured;
}

}  // namespace lab
