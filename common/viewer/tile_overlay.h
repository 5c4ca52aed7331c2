// Colours the tiles of the picture by bias, noise or sample count.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "clock.h"
#include "statistics/error_metrics.h"
#include "viewer/screen.h"
#include "viewer/session.h"

namespace lab {

enum class Overlay { none, bias, relative_bias, noise, samples };
inline constexpr const char* overlay_names[] = {"none", "bias in standard errors", "bias in percent", "noise", "sample count"};

class TileOverlay {
  public:
    Overlay shown = Overlay::none;
    void show_next();

    // Draws over the picture. Call between Screen::begin_frame() and Screen::show().
    void draw(const Session& session, const Rectangle& picture);
    // Shows in numbers the bias of the tile under the pointer.
    void explain(const Session& session, const glm::uvec2& pixel) const;
    const std::string& legend() const { return legend_; }  // of the colours

  private:
    bool shows_bias() const { return shown == Overlay::bias || shown == Overlay::relative_bias; }
    void update(const Session& session);
    void colour_bias(const Session& session);
    void colour_tiles(const FilmImage& film, const std::function<double(const NoiseEstimate&)>& heat_of);
    void colour_noise(const Session& session);
    void colour_samples(const Session& session);

    Overlay coloured_ = Overlay::none;
    uint32_t coloured_samples_ = 0;
    Clock::time_point last_update_{};
    uint32_t tile_size_ = 8;  // in pixels of the image
    glm::uvec2 tiles_{0};
    std::vector<uint32_t> colours_;  // in Dear ImGui's format
    std::string legend_;
};

}  // namespace lab
