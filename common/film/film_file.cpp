#include "film/film_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "error.h"
#include "parallel.h"

namespace lab {
namespace {

// A numeric attribute. Throws UserError if it is absent or not a number.
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

// The text attributes.
constexpr std::pair<const char*, std::string FilmHeader::*> texts[] = {
    {"chapter", &FilmHeader::chapter},       {"scene", &FilmHeader::scene},
    {"scene_hash", &FilmHeader::scene_hash}, {"estimator_hash", &FilmHeader::estimator_hash},
    {"settings", &FilmHeader::settings},     {"shows", &FilmHeader::shows},
    {"backend", &FilmHeader::backend},       {"device", &FilmHeader::device},
    {"filter", &FilmHeader::filter}};

std::string to_text(double value) {
    char buffer[32];
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

// A channel of counts per pixel; zeros if absent.
std::vector<uint32_t> counts(const ExrFile& exr, const std::string& name, size_t pixels, const std::filesystem::path& file) {
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

constexpr std::array<const char*, 3> differences{"difference.R", "difference.G", "difference.B"};

}  // namespace

void write_film(const std::filesystem::path& file, const FilmImage& image, const FilmHeader& header) {
    ExrFile exr{.image = image.mean(), .channels = {}, .attributes = {}};
    const uint32_t samples = image.min_samples();
    const uint64_t invalid = image.invalid_samples();
    exr.attributes = {{"seed", std::to_string(header.seed)}, {"first_sample", std::to_string(header.first_sample)},
                      {"samples", std::to_string(samples)},  {"invalid_samples", std::to_string(invalid)},
                      {"rays", std::to_string(header.rays)}, {"seconds", to_text(header.seconds)}};
    for (const auto& [name, text] : texts)
        if (!(header.*text).empty()) exr.attributes[name] = header.*text;
    const auto add_channel = [&](const char* name, const auto& value_of) {
        std::vector<float>& channel = exr.channels[name];
        channel.resize(image.pixels.size());
        in_parallel(channel.size(), pixels_per_piece, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) channel[i] = static_cast<float>(value_of(image.pixels[i]));
        });
    };
    for (int channel = 0; channel < 3; ++channel)
        add_channel(differences[static_cast<size_t>(channel)], [&](const FilmPixel& pixel) {
            return to_float(double{pixel.difference[channel]} / std::max(pixel.sample_count, 1u));
        });
    // Only what exceeds the smallest count, since 32-bit floats hold whole numbers only up to 2^24.
    if (image.exceeds(samples))
        add_channel("further_samples", [&](const FilmPixel& pixel) { return pixel.sample_count - samples; });
    if (invalid > 0) add_channel("invalid_samples", [](const FilmPixel& pixel) { return pixel.invalid_count; });
    write_exr(file, exr);
}

FilmFile read_film(const std::filesystem::path& file) {
    ExrFile exr = read_exr(file);
    if (!exr.is_complete) throw UserError(file.string() + ": lacks pixels of its display window: render again");
    FilmFile film;
    for (const auto& [name, text] : texts) film.header.*text = exr.attributes[name];
    if (!film.header.filter.empty())
        throw UserError(file.string() + ": is filtered (" + film.header.filter +
                        "), so it cannot be continued or merged: render without --filter");
    film.header.seed = number<uint32_t>(exr, "seed", file);
    film.header.first_sample = number<uint32_t>(exr, "first_sample", file);
    film.header.rays = number<uint64_t>(exr, "rays", file);
    film.header.seconds = number<double>(exr, "seconds", file);
    const auto require = [&](bool condition, const char* what) {
        if (!condition) throw UserError(file.string() + ": " + what + ": render again");
    };
    require(film.header.seconds >= 0 && std::isfinite(film.header.seconds), "its seconds are negative or not finite");
    const size_t count = size_t{exr.image.width} * exr.image.height;
    const auto samples = number<uint32_t>(exr, "samples", file);
    const auto further_samples = counts(exr, "further_samples", count, file);
    const auto invalid = counts(exr, "invalid_samples", count, file);
    std::array<const std::vector<float>*, 3> difference{};
    for (size_t channel = 0; channel < 3; ++channel) {
        const auto found = exr.channels.find(differences[channel]);
        if (found == exr.channels.end())
            throw UserError(file.string() + ": no channel '" + differences[channel] +
                            "', which tells its error: only an EXR written by a chapter of today can be continued or merged");
        difference[channel] = &found->second;
    }
    film.image = {exr.image.width, exr.image.height, std::vector<FilmPixel>(count)};
    in_parallel(count, 1 << 16, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            FilmPixel& pixel = film.image.pixels[i];
            const uint64_t samples_of_pixel = uint64_t{samples} + further_samples[i];
            require(samples_of_pixel <= UINT32_MAX && film.header.first_sample + samples_of_pixel <= uint64_t{1} << 32,
                    "has more samples than there are random numbers");
            pixel.sample_count = static_cast<uint32_t>(samples_of_pixel);
            pixel.invalid_count = invalid[i];
            require(pixel.invalid_count <= pixel.sample_count, "has more invalid samples than samples");
            const float* rgb = &exr.image.pixels[3 * i];
            set_sum(pixel, glm::dvec3(rgb[0], rgb[1], rgb[2]) * static_cast<double>(pixel.sample_count));
            const vec3 mean_difference((*difference[0])[i], (*difference[1])[i], (*difference[2])[i]);
            pixel.difference = mean_difference * static_cast<float>(pixel.sample_count);
            for (int channel = 0; channel < 3; ++channel)
                require(std::isfinite(pixel.sum[channel]) && std::isfinite(pixel.difference[channel]), "has infinite pixels");
        }
    });
    return film;
}

// The options of one line of settings that the other lacks.
static std::string options_beyond(const std::string& settings, const std::string& other) {
    const auto options_of = [](const std::string& line) {
        std::vector<std::string> options;
        for (size_t begin = 0, end = 0; begin < line.size(); begin = end + 1) {
            end = std::min(line.find(" --", begin), line.size());
            options.push_back(line.substr(begin, end - begin));
        }
        return options;
    };
    const std::vector<std::string> others = options_of(other);
    std::string beyond;
    for (const std::string& option : options_of(settings))
        if (std::ranges::find(others, option) == others.end()) beyond += (beyond.empty() ? "" : " ") + option;
    return beyond;
}

void require_same_render(const FilmFile& a, const FilmFile& b, const std::string& name_a, const std::string& name_b) {
    const auto require = [&](const std::string& what, const std::string& value_a, const std::string& value_b) {
        if (value_a != value_b)
            throw UserError(name_a + " and " + name_b + " do not belong together: " + what + " '" + value_a + "' against '" +
                            value_b + "'");
    };
    require("size", size_text({a.image.width, a.image.height}), size_text({b.image.width, b.image.height}));
    require("chapter", a.header.chapter, b.header.chapter);
    require("seed", std::to_string(a.header.seed), std::to_string(b.header.seed));
    require("settings", options_beyond(a.header.settings, b.header.settings),
            options_beyond(b.header.settings, a.header.settings));
    require("scene hash", a.header.scene_hash, b.header.scene_hash);
    require("shader hash", a.header.estimator_hash, b.header.estimator_hash);
}

// Adds a film to the sum of other parts of the same render.
static void add(FilmFile& sum, const FilmFile& part) {
    // If a part starts at an odd sample of the whole, its halves are swapped.
    const uint32_t first_sample = std::min(sum.header.first_sample, part.header.first_sample);
    const auto sign_of = [&](const FilmFile& film) { return (film.header.first_sample - first_sample) % 2 == 0 ? 1.0f : -1.0f; };
    const float sign_of_sum = sign_of(sum), sign_of_part = sign_of(part);
    in_parallel(sum.image.pixels.size(), 1 << 16, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            FilmPixel& pixel = sum.image.pixels[i];
            const FilmPixel& added = part.image.pixels[i];
            set_sum(pixel, sum_of(pixel) + glm::dvec3(added.sum) + glm::dvec3(added.compensation));
            pixel.difference = sign_of_sum * pixel.difference + sign_of_part * added.difference;
            pixel.sample_count += added.sample_count;
            pixel.invalid_count += added.invalid_count;
        }
    });
    sum.header.first_sample = first_sample;
    sum.header.rays += part.header.rays;
    sum.header.seconds += part.header.seconds;
    if (sum.header.backend != part.header.backend) sum.header.backend = "several";
    if (sum.header.device != part.header.device) sum.header.device = "several";
}

FilmFile merge_films(const std::vector<std::filesystem::path>& files) {
    if (files.empty()) throw UserError("nothing to merge: name at least one .exr");
    struct Range {
        uint64_t begin, end;
        std::string name;
    };
    std::vector<Range> ranges;
    FilmFile merged;
    for (const auto& file : files) {  // one at a time: there may be many, and large ones
        FilmFile part = read_film(file);
        const uint32_t samples = part.image.min_samples();
        if (part.image.exceeds(samples))
            throw UserError(file.string() + " is an unfinished render: finish it with --resume first");
        const uint64_t begin = part.header.first_sample;
        ranges.push_back({begin, begin + samples, file.string()});
        if (ranges.size() == 1) {
            merged = std::move(part);
        } else {
            require_same_render(merged, part, files.front().string(), file.string());
            add(merged, part);
        }
    }
    std::ranges::sort(ranges, {}, &Range::begin);
    for (size_t i = 1; i < ranges.size(); ++i) {
        const auto& [begin, end, name] = ranges[i];
        const Range& before = ranges[i - 1];
        if (begin != before.end)
            throw UserError(before.name + " ends before sample " + std::to_string(before.end) + " and " + name + " starts at " +
                            std::to_string(begin) + ": the ranges must join without overlap or gap");
        if (end - ranges.front().begin > UINT32_MAX)
            throw UserError(name + " ends at sample " + std::to_string(end) + ": a merged render has at most 2^32 - 1 samples");
    }
    return merged;
}

}  // namespace lab
