// The inside view: live verdict, tiles, a pixel's path, and what its vertices see.
#pragma once
#include "inspection/hemisphere_view.h"
#include "inspection/light_branches.h"
#include "viewer/session.h"
#include "viewer/tile_overlay.h"

namespace lab {

// The paths of a selected pixel, one at a time, and what their vertices see.
class Inspection {
  public:
    explicit Inspection(const Device& device) : device_(device) {}

    void select(uvec2 pixel) { selection_ = {pixel, 0, 0}; }
    void deselect() { selection_.reset(); }
    struct Selection {
        uvec2 pixel;
        uint32_t sample;  // relative to the render's first
        size_t vertex;    // whose hemisphere is shown
        bool operator==(const Selection&) const = default;
    };
    // Changes take effect at the next update.
    std::optional<Selection>& selection() { return selection_; }
    const std::optional<Selection>& selection() const { return selection_; }

    // Updates the path, and renders the hemisphere for about this many seconds.
    void update(const Session& session, double seconds);

    bool is_building() const { return work_.is_under_way(); }  // shaders, in the background
    const std::string& message() const { return message_; }    // why there is nothing to see, or empty
    // Empty while shaders compile or the camera moves.
    const std::optional<RecordedPath>& path() const { return path_; }
    const RenderParameters& parameters() const { return parameters_; }  // of the path
    bool has_hemisphere() const { return has_hemisphere_; }             // at the chosen vertex
    const HemisphereView& hemisphere() const { return *tools_->hemisphere; }

  private:
    // Keep alive what they need of a build that may be replaced.
    struct Tools {
        std::shared_ptr<const Scene> scene;
        std::shared_ptr<const GpuScene> gpu_scene;
        std::shared_ptr<const SceneBackend> scene_backend;
        Estimator estimator;
        uint64_t hash;  // of what they are compiled from
        RenderParameters parameters;
        std::unique_ptr<PathRecorder> recorder = nullptr;
        std::unique_ptr<HemisphereView> hemisphere = nullptr;
        std::unique_ptr<LightBranches> light_branches = nullptr;  // if light samples choose by the tree
    };
    bool have_tools(const Session& session);

    const Device& device_;
    std::optional<Selection> selection_, shown_;
    std::shared_ptr<Tools> tools_;
    BackgroundWork<std::shared_ptr<Tools>> work_;
    uint64_t work_hash_ = 0;  // of the tools in progress
    uint64_t failed_hash_ = 0;
    std::string message_;
    std::optional<RecordedPath> path_;
    RenderParameters parameters_{};
    bool has_hemisphere_ = false;
};

class InspectionPanel {
  public:
    explicit InspectionPanel(const Device& device) : inspection_(device) {}

    // Draws over the picture, and a panel for the path of a selected pixel. Renders hemispheres for about this many seconds. Call
    // between Screen::begin_frame() and Screen::show().
    // `beside` is a second render that shows the picture right of `split`, a fraction of its width, or null.
    void draw(const Session& session, const Session* beside, float split, const Rectangle& picture, const Rectangle& panel,
              double seconds);
    int height() const;  // of the panel, in framebuffer pixels
    // Draws a section of the controls.
    void draw_controls(Session& session);
    const Inspection& inspection() const { return inspection_; }
    void show_next_overlay() { overlay_.show_next(); }

  private:
    void select_clicked_pixel(const Session& session, float split, const Rectangle& picture);
    void draw_verdict(const Session& session);
    void draw_pixel(const Session& session);
    void draw_panel(const std::string& whose, const Rectangle& panel);
    void draw_sample();
    void draw_vertices();
    void draw_hemisphere();

    Inspection inspection_;
    TileOverlay overlay_;
    std::optional<glm::uvec2> hovered_;  // pixel
    bool is_beside_ = false;             // whether the selected path is that of the second render
    bool was_dragged_ = false;           // since the mouse button was pressed
    HemisphereView::Pictures pictures_;
    double pictures_samples_ = -1;
};

}  // namespace lab
