#include "film/film_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "error.h"

namespace lab {
namespace {

// Attribute of the EXR as a number; an error if it is absent or no number.
template <typename T>
T number(const ExrFile& exr, const std::string& name, const std::filesystem::path& file) {
    T value{};
    const auto found = exr.attributes.find(name);
    if (found != exr.attributes.end()) {
        const std::string& text = found->second;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error == std::errc() && end == text.data() + text.size()) return value;
    }
    throw UserError(file.string() + ": no attribute '" + name +
                    "' that is a number: only an EXR written by a chapter can be continued or merged");
}

std::string text(const ExrFile& exr, const std::string& name) {
    const auto found = exr.attributes.find(name);
    return found == exr.attributes.end() ? "" : found->second;
}

std::string to_text(double value) {
    char buffer[32];
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

// Channel with one count a pixel, zeros if it is absent.
std::vector<uint32_t> counts(const ExrFile& exr, const std::string& name, size_t pixels,
                             const std::filesystem::path& file) {
    std::vector<uint32_t> result(pixels, 0);
    const auto found = exr.channels.find(name);
    if (found == exr.channels.end()) return result;
    for (size_t i = 0; i < pixels; ++i) {
        const double count = found->second[i];
        if (!(count >= 0 && count < 4294967296.0))
            throw UserError(file.string() + ": the channel '" + name + "' is damaged: render again");
        result[i] = static_cast<uint32_t>(count);
    }
    return result;
}

// Splits a sum in double into the two floats that the device goes on with.
void set_sum(FilmPixel& pixel, int channel, double sum) {
    pixel.sum[channel] = static_cast<float>(sum);
    pixel.compensation[channel] = static_cast<float>(sum - double{pixel.sum[channel]});
}

}  // namespace

void write_film(const std::filesystem::path& file, const FilmImage& image, const FilmRecord& record) {
    ExrFile exr{.image = image.mean(), .channels = {}, .attributes = {}};
    const uint32_t samples = image.min_samples();
    exr.attributes = {{"chapter", record.chapter},
                      {"scene", record.scene},
                      {"scene_hash", record.scene_hash},
                      {"estimator_hash", record.estimator_hash},
                      {"settings", record.settings},
                      {"backend", record.backend},
                      {"device", record.device},
                      {"seed", std::to_string(record.seed)},
                      {"first_sample", std::to_string(record.first_sample)},
                      {"samples", std::to_string(samples)},
                      {"invalid_samples", std::to_string(image.invalid_samples())},
                      {"rays", std::to_string(record.rays)},
                      {"seconds", to_text(record.seconds)}};
    // Relative to the fewest, since floats hold whole numbers only up to 2^24.
    if (!image.has_equal_sample_counts())
        for (const auto& pixel : image.pixels)
            exr.channels["further_samples"].push_back(static_cast<float>(pixel.sample_count - samples));
    if (image.invalid_samples() > 0)
        for (const auto& pixel : image.pixels)
            exr.channels["invalid_samples"].push_back(static_cast<float>(pixel.invalid_count));
    write_exr(file, exr);
}

FilmFile read_film(const std::filesystem::path& file) {
    const ExrFile exr = read_exr(file);
    FilmFile film;
    film.record = {.chapter = text(exr, "chapter"),
                   .scene = text(exr, "scene"),
                   .scene_hash = text(exr, "scene_hash"),
                   .estimator_hash = text(exr, "estimator_hash"),
                   .settings = text(exr, "settings"),
                   .backend = text(exr, "backend"),
                   .device = text(exr, "device"),
                   .seed = number<uint32_t>(exr, "seed", file),
                   .first_sample = number<uint32_t>(exr, "first_sample", file),
                   .rays = number<uint64_t>(exr, "rays", file),
                   .seconds = number<double>(exr, "seconds", file)};
    const size_t count = size_t{exr.image.width} * exr.image.height;
    const auto samples = number<uint32_t>(exr, "samples", file);
    const auto further_samples = counts(exr, "further_samples", count, file);
    const auto invalid = counts(exr, "invalid_samples", count, file);
    film.image = {exr.image.width, exr.image.height, std::vector<FilmPixel>(count)};
    for (size_t i = 0; i < count; ++i) {
        FilmPixel& pixel = film.image.pixels[i];
        pixel.sample_count = samples + further_samples[i];
        pixel.invalid_count = invalid[i];
        for (int channel = 0; channel < 3; ++channel) {
            const double mean = exr.image.pixels[3 * i + static_cast<size_t>(channel)];
            if (!std::isfinite(mean)) throw UserError(file.string() + ": has infinite pixels: render again");
            set_sum(pixel, channel, mean * pixel.sample_count);
        }
    }
    return film;
}

void require_same_render(const FilmFile& a, const FilmFile& b, const std::string& name_a,
                         const std::string& name_b) {
    const auto require = [&](const std::string& what, const std::string& value_a,
                             const std::string& value_b) {
        if (value_a != value_b)
            throw UserError(name_a + " and " + name_b + " do not belong together: " + what + " '" + value_a +
                            "' against '" + value_b + "'");
    };
    const auto size = [](const FilmImage& image) {
        return std::to_string(image.width) + "x" + std::to_string(image.height);
    };
    require("size", size(a.image), size(b.image));
    require("chapter", a.record.chapter, b.record.chapter);
    require("seed", std::to_string(a.record.seed), std::to_string(b.record.seed));
    require("settings", a.record.settings, b.record.settings);
    require("scene hash", a.record.scene_hash, b.record.scene_hash);
    require("shader hash", a.record.estimator_hash, b.record.estimator_hash);
}

FilmFile merge_films(const std::vector<std::filesystem::path>& files) {
    struct Part {
        std::string name;
        FilmFile film;
        uint64_t end;  // one past its last sample
    };
    std::vector<Part> parts;
    for (const auto& file : files) {
        parts.push_back({file.string(), read_film(file), 0});
        auto& [name, film, end] = parts.back();
        const uint32_t samples = film.image.min_samples();
        if (!film.image.has_equal_sample_counts())
            throw UserError(name + " is an unfinished render: finish it with --resume first");
        end = uint64_t{film.record.first_sample} + samples;
    }
    if (parts.empty()) throw UserError("nothing to merge: name at least one .exr");
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return a.film.record.first_sample < b.film.record.first_sample;
    });
    FilmFile merged = parts.front().film;
    for (size_t i = 1; i < parts.size(); ++i) {
        const auto& [name, film, end] = parts[i];
        require_same_render(parts.front().film, film, parts.front().name, name);
        if (film.record.first_sample != parts[i - 1].end)
            throw UserError(parts[i - 1].name + " ends before sample " + std::to_string(parts[i - 1].end) +
                            " and " + name + " starts at " + std::to_string(film.record.first_sample) +
                            ": the ranges must join without overlap or gap");
        if (end - parts.front().film.record.first_sample > UINT32_MAX)
            throw UserError(name + " ends at sample " + std::to_string(end) +
                            ": a merged render has at most 2^32 - 1 samples");
        for (size_t p = 0; p < merged.image.pixels.size(); ++p) {
            FilmPixel& sum = merged.image.pixels[p];
            const FilmPixel& added = film.image.pixels[p];
            for (int channel = 0; channel < 3; ++channel)
                set_sum(sum, channel,
                        double{sum.sum[channel]} + double{sum.compensation[channel]} +
                            double{added.sum[channel]} + double{added.compensation[channel]});
            sum.sample_count += added.sample_count;
            sum.invalid_count += added.invalid_count;
        }
        merged.record.rays += film.record.rays;
        merged.record.seconds += film.record.seconds;
        if (merged.record.backend != film.record.backend) merged.record.backend = "several";
        if (merged.record.device != film.record.device) merged.record.device = "several";
    }
    return merged;
}

}  // namespace lab
