// Finds the nodes of the light tree by which light samples have come to their lamps.
#pragma once
#include "inspection/path_recorder.h"
#include "scene/light_tree.h"

namespace lab {

class LightBranches {
  public:
    // Builds the tree once more. The scene must outlive it.
    explicit LightBranches(const Scene& scene);

    // Fills in `branch` of all light samples of a path.
    void add_to(RecordedPath& path) const;
    // The spheres of the nodes above the lamp that is at a point and seen from `from`, and last that of the lamp itself. Empty if
    // there is none.
    std::vector<Sphere> find(const vec3& from, const vec3& point) const;

  private:
    struct Search;
    void visit(uint32_t node, Search& search) const;
    // 0 for points on the triangle.
    double relative_distance(const LightTriangle& light, const vec3& point) const;

    const Scene& scene_;
    LightTable table_;
    LightTree tree_;
};

}  // namespace lab
