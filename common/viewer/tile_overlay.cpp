#include "viewer/tile_overlay.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "viewer/inspection_drawing.h"

namespace lab {
namespace {

constexpr float opacity = 0.7f;
constexpr uint32_t most_tiles = 64;  // per row: drawing more would be slow

// From dark blue at 0 to yellow at 1.
uint32_t heat(double value) {
    const float x = static_cast<float>(std::clamp(value, 0.0, 1.0));
    return ImGui::GetColorU32(ImVec4(std::min(1.6f * x, 1.0f), x, 0.4f * (1 - x), opacity));
}

std::string text(const char* format, double a, double b) {
    char buffer[120];
    std::snprintf(buffer, sizeof buffer, format, a, b);
    return buffer;
}

// The bias shown in saturated colour, rounded up to 1, 2, 5, … 100 %.
double full_colour_at(double largest) {
    for (const double part : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5})
        if (largest <= part) return part;
    return 1;
}

// Edge length of the square tiles: not too small, and not too many of them.
uint32_t tile_size_for(const glm::uvec2& image_size) {
    return std::max(8u, (std::max(image_size.x, image_size.y) + most_tiles - 1) / most_tiles);
}

}  // namespace

void TileOverlay::show_next() { shown = static_cast<Overlay>((static_cast<size_t>(shown) + 1) % std::size(overlay_names)); }

void TileOverlay::draw(const Session& session, const Rectangle& picture) {
    update(session);
    if (colours_.empty()) return;
    const Placement placement(picture);
    const glm::uvec2 image = session.build().job.parameters.image_size;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (uint32_t y = 0; y < tiles_.y; ++y)
        for (uint32_t x = 0; x < tiles_.x; ++x) {
            const glm::uvec2 first(x * tile_size_, y * tile_size_), last = glm::min(first + tile_size_, image);
            list.AddRectFilled(placement.at(glm::vec2(first) / glm::vec2(image)),
                               placement.at(glm::vec2(last) / glm::vec2(image)), colours_[size_t{y} * tiles_.x + x]);
        }
}

// Recolours only when something has changed.
void TileOverlay::update(const Session& session) {
    if (shown == Overlay::none || session.reduction() > 1) {
        colours_.clear();
        legend_.clear();
        coloured_ = Overlay::none;
        return;
    }
    uint32_t samples = session.last_snapshot().min_samples();
    const Verdict* verdict = session.latest_verdict();
    if (shows_bias()) samples = verdict ? verdict->samples : 0;
    const bool is_old = shown == Overlay::samples && seconds_since(last_update_) > 0.5;
    if (coloured_ == shown && coloured_samples_ == samples && !is_old) return;
    coloured_ = shown;
    coloured_samples_ = samples;
    last_update_ = Clock::now();
    colours_.clear();
    if (shows_bias()) return colour_bias(session);
    const glm::uvec2 image = session.build().job.parameters.image_size;
    tile_size_ = tile_size_for(image);
    tiles_ = (image + tile_size_ - 1u) / tile_size_;
    if (shown == Overlay::noise) return colour_noise(session);
    colour_samples(session);
}

void TileOverlay::colour_bias(const Session& session) {
    const Verdict* verdict = session.latest_verdict();
    if (!verdict) {
        legend_ = session.verdict_text();
        return;
    }
    tile_size_ = verdict->map_tile_size;
    tiles_ = {verdict->map.width, verdict->map.height};
    const auto add = [&](const std::array<uint8_t, 3>& rgb) {
        colours_.push_back(IM_COL32(rgb[0], rgb[1], rgb[2], 255 * opacity));
    };
    legend_ = "red: too bright, blue: too dark, full colour at ";
    if (shown == Overlay::bias) {
        for (const double z : verdict->map.values) add(z_colour(z));
        legend_ += "5 standard errors";
        return;
    }
    // In dark tiles noise may be any fraction of the mean: colour only what is certain.
    const auto certain = [&](size_t i) { return std::abs(verdict->map.values[i]) >= 5 ? verdict->map_differences[i].value : 0; };
    double largest = 0;
    for (size_t i = 0; i < verdict->map.values.size(); ++i) largest = std::max(largest, std::abs(certain(i)));
    const double full = full_colour_at(largest);
    for (size_t i = 0; i < verdict->map.values.size(); ++i) add(signed_colour(certain(i) / full));
    legend_ += text("%.0f %% of the reference; white: less than %.0f standard errors", 100 * full, 5);
}

void TileOverlay::explain(const Session& session, const glm::uvec2& pixel) const {
    const Verdict* verdict = session.latest_verdict();
    if (!shows_bias() || !verdict || colours_.empty()) return;
    const glm::uvec2 at = pixel / verdict->map_tile_size;
    if (at.x >= verdict->map.width || at.y >= verdict->map.height) return;  // of another image, about to be replaced
    const size_t i = size_t{at.y} * verdict->map.width + at.x;
    ImGui::SetTooltip("this tile: %s of the reference,\n%+.1f standard errors",
                      interval_text(verdict->map_differences[i]).c_str(), verdict->map.values[i]);
}

// Colours each tile by `heat_of` of its estimate.
void TileOverlay::colour_tiles(const FilmImage& film, const std::function<double(const NoiseEstimate&)>& heat_of) {
    for (uint32_t y = 0; y < tiles_.y; ++y)
        for (uint32_t x = 0; x < tiles_.x; ++x)
            colours_.push_back(heat(heat_of(estimate_noise(film, glm::uvec2(x, y) * tile_size_, glm::uvec2(tile_size_)))));
}

void TileOverlay::colour_noise(const Session& session) {
    const FilmImage& film = session.last_snapshot();
    if (film.min_samples() < 2) {
        legend_ = "the noise is not known yet";
        return;
    }
    // Decades from 0.1 % to 100 %.
    colour_tiles(film, [](const NoiseEstimate& noise) { return (3 + std::log10(std::max(noise.relative_error, 1e-9))) / 3; });
    legend_ = text("standard error of a pixel as part of its tile's mean: dark 0.1 %%, yellow 100 %%; %.0f samples",
                   film.min_samples(), 0);
}

void TileOverlay::colour_samples(const Session& session) {
    const FilmImage film = session.build().renderer->film().read();
    const auto [fewest, most] = std::ranges::minmax(film.pixels, {}, &FilmPixel::sample_count);
    const double low = fewest.sample_count, high = most.sample_count;
    colour_tiles(film, [&](const NoiseEstimate& tile) { return high > low ? (tile.samples - low) / (high - low) : 1; });
    legend_ = text("samples of a pixel: dark %.0f, yellow %.0f", low, high);
}

}  // namespace lab
