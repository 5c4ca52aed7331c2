#include "tracing/bvh_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "parallel.h"

namespace lab::bvh {
namespace {

constexpr size_t max_bin_count = 32;
constexpr size_t max_leaf_triangles = 4;
// Where this many splits might come to lie above each other, ranges are halved instead: that bounds the stack
// of the traversal. Only triangles whose sizes fall geometrically need so many.
constexpr size_t max_depth = 64;
constexpr size_t smallest_task = 32'768;  // less is not worth to be shared
constexpr size_t max_tasks = 64;          // of equal size; a few more if they are not

using Int4 [[gnu::vector_size(16)]] = int;

const Box empty_box{Float4{} + std::numeric_limits<float>::infinity(),
                    Float4{} - std::numeric_limits<float>::infinity()};

// Sorts centroids into bins of equal width along each axis.
struct Binning {
    int bin_count;
    Float4 low;
    Float4 bins_per_length{};

    Binning(const Box& centroids, size_t primitive_count)
        : bin_count(static_cast<int>(std::min(max_bin_count, primitive_count))), low(centroids.low) {
        // An axis along which the bins have no width, or hardly any, keeps all centroids in bin 0.
        for (int axis = 0; axis < 3; ++axis) {
            const float scale = static_cast<float>(bin_count) / (centroids.high[axis] - low[axis]);
            if (std::isfinite(scale)) bins_per_length[axis] = scale;
        }
    }
    Int4 bins(const Primitive& primitive) const {
        const Int4 last = Int4{} + (bin_count - 1);
        const Int4 bins = __builtin_convertvector((primitive.centroid() - low) * bins_per_length, Int4);
        return bins < last ? bins : last;
    }
};

// What the bins of all axes hold.
struct Bins {
    struct Bin {
        Box box;
        size_t count;

        void add(const Bin& bin) {
            box.add(bin.box);
            count += bin.count;
        }
    };
    static inline const Bin no_primitives{empty_box, 0};
    int bin_count;
    std::array<std::array<Bin, max_bin_count>, 3> axes;  // the first bin_count of each are in use

    explicit Bins(int count) : bin_count(count) {
        for (auto& bins : axes) std::fill_n(bins.begin(), bin_count, no_primitives);
    }

    void add(std::span<const Primitive> primitives, const Binning& binning) {
        for (const auto& primitive : primitives) {
            const Int4 bins = binning.bins(primitive);
            const Bin one{primitive.box(), 1};
            axes[0][bins[0]].add(one);  // not in a loop, so that the compiler knows the lanes
            axes[1][bins[1]].add(one);
            axes[2][bins[2]].add(one);
        }
    }
    void add(const Bins& bins) {
        for (size_t axis = 0; axis < 3; ++axis)
            for (int i = 0; i < bin_count; ++i) axes[axis][i].add(bins.axes[axis][i]);
    }
    // Of bins begin, ..., end - 1 along an axis.
    Bin sum(int axis, int begin, int end) const {
        Bin sum = no_primitives;
        for (int i = begin; i < end; ++i) sum.add(axes[axis][i]);
        return sum;
    }
};

struct Plane {
    int axis = 0;
    int first_right_bin = 0;
    double cost = std::numeric_limits<double>::infinity();  // area times triangles, added over both sides
};

// The plane between two bins with the least surface area cost.
Plane cheapest_plane(const Bins& bins, size_t primitive_count) {
    const auto cost_of = [](const Bins::Bin& side) {
        return half_area(side.box.high - side.box.low) * static_cast<double>(side.count);
    };
    Plane best;
    for (int axis = 0; axis < 3; ++axis) {
        // right_cost[i] belongs to bins i, i + 1, ... A side without triangles makes no split.
        std::array<double, max_bin_count> right_cost;
        Bins::Bin side = Bins::no_primitives;
        for (int i = bins.bin_count - 1; i > 0; --i) {
            side.add(bins.axes[axis][i]);
            right_cost[i] = cost_of(side);
        }
        side = Bins::no_primitives;
        for (int i = 1; i < bins.bin_count; ++i) {
            side.add(bins.axes[axis][i - 1]);
            if (side.count == 0 || side.count == primitive_count) continue;
            const double cost = cost_of(side) + right_cost[i];
            if (cost < best.cost) best = {axis, i, cost};
        }
    }
    return best;
}

// Halves along the longest axis, where all centroids coincide or the tree is too deep.
std::array<Range, 2> halve(const Range& range, const Box& centroids) {
    const auto primitives = range.primitives;
    const auto [low, high] = centroids.bounds();
    const vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const size_t middle = primitives.size() / 2;
    std::ranges::nth_element(primitives, primitives.begin() + middle, {},
                             [&](const Primitive& p) { return float{p.centroid()[axis]}; });
    const auto left = primitives.first(middle), right = primitives.subspan(middle);
    return {Range{left, bounds_of(left), range.depth + 1}, Range{right, bounds_of(right), range.depth + 1}};
}

// Of a range that is larger than a task: primitives that a thread takes at a time.
size_t piece_size(size_t primitive_count) {
    constexpr size_t smallest_piece = 4096;
    return std::max(smallest_piece, primitive_count / max_tasks);
}

}  // namespace

Bounds bounds_of(std::span<const Primitive> primitives) {
    Box box = empty_box;
    for (const auto& primitive : primitives) box.add(primitive.box());
    return box.bounds();
}

Splitter::Splitter(std::span<const Primitive> primitives)
    : primitives_(primitives),
      scratch_(std::make_unique_for_overwrite<Primitive[]>(primitives.size())),
      task_size_(std::max(smallest_task, primitives.size() / max_tasks)) {}

// Adds all primitives to `sum`, which is empty: large ranges piece by piece, merged in their order.
template <typename Sum, typename Add>
void Splitter::gather(std::span<const Primitive> primitives, Sum& sum, const Add& add) const {
    if (primitives.size() <= task_size_) return add(sum, primitives);
    const size_t size = piece_size(primitives.size());
    std::vector<Sum> pieces((primitives.size() + size - 1) / size, sum);
    in_parallel(primitives.size(), size, [&](size_t begin, size_t end) {
        add(pieces[begin / size], primitives.subspan(begin, end - begin));
    });
    for (const Sum& piece : pieces) sum.add(piece);
}

// Left ones first, each side in its order: pieces know where theirs go from how many the others have.
template <typename IsLeft>
void Splitter::partition(std::span<Primitive> primitives, const IsLeft& is_left) const {
    if (primitives.size() <= task_size_) {
        std::partition(primitives.begin(), primitives.end(), is_left);
        return;
    }
    const size_t count = primitives.size(), size = piece_size(count);
    std::vector<size_t> left_before((count + size - 1) / size + 1);
    in_parallel(count, size, [&](size_t begin, size_t end) {
        left_before[begin / size + 1] =
            std::count_if(primitives.begin() + begin, primitives.begin() + end, is_left);
    });
    std::partial_sum(left_before.begin(), left_before.end(), left_before.begin());
    const auto target = std::span(scratch_.get() + (primitives.data() - primitives_.data()), count);
    in_parallel(count, size, [&](size_t begin, size_t end) {
        size_t left = left_before[begin / size], right = left_before.back() + begin - left;
        for (const Primitive& primitive : primitives.subspan(begin, end - begin))
            target[is_left(primitive) ? left++ : right++] = primitive;
    });
    in_parallel(count, size, [&](size_t begin, size_t end) {
        std::copy(target.begin() + begin, target.begin() + end, primitives.begin() + begin);
    });
}

std::optional<std::array<Range, 2>> Splitter::split(const Range& range) const {
    const auto primitives = range.primitives;
    if (primitives.size() < 2) return {};
    Box centroids = empty_box;
    gather(primitives, centroids, [](Box& box, std::span<const Primitive> piece) {
        for (const auto& primitive : piece) box.add({primitive.centroid(), primitive.centroid()});
    });
    const Binning binning(centroids, primitives.size());
    Bins bins(binning.bin_count);
    Plane plane;
    if (range.depth + std::bit_width(primitives.size()) < max_depth) {
        gather(primitives, bins,
               [&](Bins& some, std::span<const Primitive> piece) { some.add(piece, binning); });
        plane = cheapest_plane(bins, primitives.size());
    }
    const double area = half_area(range.bounds);
    const double leaf_cost = area * static_cast<double>(primitives.size());
    if (primitives.size() <= max_leaf_triangles && !(area + plane.cost < leaf_cost)) return {};
    if (!std::isfinite(plane.cost)) return halve(range, centroids);

    const auto left = bins.sum(plane.axis, 0, plane.first_right_bin),
               right = bins.sum(plane.axis, plane.first_right_bin, binning.bin_count);
    partition(primitives, [&](const Primitive& primitive) {
        return binning.bins(primitive)[plane.axis] < plane.first_right_bin;
    });
    return {{Range{primitives.first(left.count), left.box.bounds(), range.depth + 1},
             Range{primitives.subspan(left.count), right.box.bounds(), range.depth + 1}}};
}

}  // namespace lab::bvh
