#include "tracing/bvh_split.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "parallel.h"

namespace lab::bvh {
namespace {

constexpr size_t max_bin_count = 32;
constexpr size_t max_leaf_triangles = 4;
// Where this many splits might come to lie above each other, ranges are halved instead: that bounds the stack
// of the traversal. Only triangles whose sizes fall geometrically need so many.
constexpr size_t max_depth = 64;

using Int4 [[gnu::vector_size(16)]] = int;

// Primitives on one side of a plane.
struct Side {
    Box box;
    uint32_t count;

    void add(const Side& side) {
        box.add(side.box);
        count += side.count;
    }
    double cost() const { return box.half_area() * count; }  // not a number if there are none
};

const Side no_primitives{empty_box, 0};

// A plane between two bins.
struct Plane {
    double cost = std::numeric_limits<double>::infinity();  // added over both sides
    int axis = 0;
    int first_right_bin = 0;
};

// The primitives of a range, sorted by their places into bins of equal width along each axis.
class Bins {
  public:
    explicit Bins(const Range& range)
        : bin_count_(static_cast<int>(std::min(max_bin_count, 4 + range.primitives.size() / 2))),
          low_(range.places.low),
          last_(Float4{} + (static_cast<float>(bin_count_) - 0.5f)) {
        // An axis along which the bins have no width, or hardly any, keeps all primitives in bin 0.
        const Float4 scale = static_cast<float>(bin_count_) / (range.places.high - low_);
        bins_per_length_ = scale <= std::numeric_limits<float>::max() ? scale : Float4{};
        for (auto& bins : axes_) std::fill_n(bins.begin(), bin_count_, no_primitives);
    }
    void add(std::span<const Primitive> primitives) {
        // Neighbours are often in the same bin, which would have to wait for the one before: so by turns.
        const size_t middle = primitives.size() / 2;
        for (size_t i = 0; i < middle; ++i) {
            add(primitives[i]);
            add(primitives[middle + i]);
        }
        if (primitives.size() % 2 != 0) add(primitives.back());
    }
    void add(const Bins& bins) {
        for (size_t axis = 0; axis < 3; ++axis)
            for (int i = 0; i < bin_count_; ++i) axes_[axis][i].add(bins.axes_[axis][i]);
    }

    bool is_left(const Primitive& primitive, const Plane& plane) const {
        const float place = (primitive.place(plane.axis) - low_[plane.axis]) * bins_per_length_[plane.axis];
        return place < static_cast<float>(plane.first_right_bin);
    }
    Side left(const Plane& plane) const { return sum(plane.axis, 0, plane.first_right_bin); }
    Side right(const Plane& plane) const { return sum(plane.axis, plane.first_right_bin, bin_count_); }

    // The plane with the least surface area cost. A side without triangles makes no split.
    Plane cheapest_plane() const {
        Plane best;
        for (int axis = 0; axis < 3; ++axis) {
            std::array<double, max_bin_count> right_cost;  // of bins i, i + 1, ...
            Side side = no_primitives;
            for (int i = bin_count_ - 1; i > 0; --i) {
                side.add(axes_[axis][i]);
                right_cost[i] = side.cost();
            }
            side = no_primitives;
            for (int i = 1; i < bin_count_; ++i) {
                side.add(axes_[axis][i - 1]);
                const double cost = side.cost() + right_cost[i];
                if (cost < best.cost) best = {cost, axis, i};
            }
        }
        return best;
    }

  private:
    void add(const Primitive& primitive) {
        const Float4 place = (primitive.place() - low_) * bins_per_length_;
        const Int4 bins = __builtin_convertvector(place < last_ ? place : last_, Int4);
        const Side one{primitive.box(), 1};
        // Not in a loop, so that the compiler knows the lanes.
        axes_[0][static_cast<uint32_t>(bins[0])].add(one);
        axes_[1][static_cast<uint32_t>(bins[1])].add(one);
        axes_[2][static_cast<uint32_t>(bins[2])].add(one);
    }
    Side sum(int axis, int begin, int end) const {
        Side sum = no_primitives;
        for (int i = begin; i < end; ++i) sum.add(axes_[axis][i]);
        return sum;
    }

    int bin_count_;
    Float4 low_;
    Float4 bins_per_length_;
    Float4 last_;                                          // the middle of the last bin, counted in bins
    std::array<std::array<Side, max_bin_count>, 3> axes_;  // the first bin_count_ of each are in use
};

// A half of a range, whose primitives have still to move there: the bounds of their places come from that.
Range part_of(const Range& range, size_t begin, size_t count, const Box& box) {
    return {.primitives = {range.room + begin, count},
            .room = range.primitives.data() + begin,
            .box = box,
            .places = empty_box,
            .area = box.half_area(),
            .first = static_cast<uint32_t>(range.first + begin),
            .depth = range.depth + 1};
}

Halves halves_of(const Range& range, const Side& left, const Side& right) {
    return {part_of(range, 0, left.count, left.box), part_of(range, left.count, right.count, right.box)};
}
Halves halves_of(const Range& range, const Bins& bins, const Plane& plane) {
    return halves_of(range, bins.left(plane), bins.right(plane));
}

Extent extent_of(std::span<const Primitive> primitives) {
    Extent extent;
    for (const Primitive& primitive : primitives) extent.add(primitive);
    return extent;
}

// Halves along the longest axis, where all places coincide or the tree is too deep.
Halves halve(const Range& range) {
    const auto [low, high] = range.places.bounds();
    const vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const size_t count = range.primitives.size(), middle = count / 2;
    std::ranges::nth_element(range.primitives, range.primitives.begin() + middle, {},
                             [&](const Primitive& primitive) { return primitive.place(axis); });
    std::ranges::copy(range.primitives, range.room);
    const Extent left = extent_of({range.room, middle}),
                 right = extent_of({range.room + middle, count - middle});
    Halves halves = halves_of(range, {left.box, static_cast<uint32_t>(middle)},
                              {right.box, static_cast<uint32_t>(count - middle)});
    halves[0].places = left.places;
    halves[1].places = right.places;
    return halves;
}

Plane plane_for(const Range& range, const Bins& bins) {
    if (range.depth + std::bit_width(range.primitives.size()) >= max_depth) return {};
    return bins.cheapest_plane();
}

// Moves primitives to their sides, each in their order: those on the left to room[next[0]] and so on, those
// on the right to room[next[1]]. Returns the bounds of their places on either side. There is no branch to
// mispredict.
std::array<Box, 2> move(std::span<const Primitive> primitives, const Bins& bins, const Plane& plane,
                        Primitive* room, std::array<size_t, 2> next) {
    auto [left, right] = next;
    std::array places{empty_box, empty_box};
    for (const Primitive& primitive : primitives) {
        const int is_left = bins.is_left(primitive, plane);
        room[is_left ? left : right] = primitive;
        left += is_left;
        right += 1 - is_left;
        // A number with all bits set is not a number, and no box takes it.
        const Int4 place = std::bit_cast<Int4>(primitive.place()), on_left = Int4{} - is_left;
        places[0].add(std::bit_cast<Float4>(place | ~on_left));
        places[1].add(std::bit_cast<Float4>(place | on_left));
    }
    return places;
}

// The cheapest of all ways to divide a few primitives in two. The first one stays on the left.
std::optional<Halves> split_few(const Range& range) {
    const auto primitives = range.primitives;
    if (primitives.size() < 2) return {};
    double best_cost = range.area * static_cast<double>(primitives.size() - 1);  // a leaf's less a node's
    uint32_t best = 0;  // has a bit for each primitive: whether it goes to the right
    std::array<Side, 2> best_sides;
    for (uint32_t right = 2; right < 1u << primitives.size(); right += 2) {
        std::array sides{no_primitives, no_primitives};
        for (size_t i = 0; i < primitives.size(); ++i) sides[right >> i & 1].add({primitives[i].box(), 1});
        const double cost = sides[0].cost() + sides[1].cost();
        if (cost < best_cost) {
            best_cost = cost;
            best = right;
            best_sides = sides;
        }
    }
    if (best == 0) return {};
    std::array<size_t, 2> next{0, best_sides[0].count};
    for (size_t i = 0; i < primitives.size(); ++i) range.room[next[best >> i & 1]++] = primitives[i];
    return halves_of(range, best_sides[0], best_sides[1]);
}

// What a thread takes of a large range.
struct Piece {
    const Range* range;
    std::span<const Primitive> primitives;
    std::unique_ptr<Bins> bins{};
    Plane plane{};
    std::array<size_t, 2> next{};  // where in the room its primitives on the left and right go
    std::array<Box, 2> places{};
};

// A large range on its way to its halves. It gets none if no plane can split it.
struct LargeSplit {
    Range* range;
    size_t first_piece = 0, piece_count = 0;
    std::optional<Halves> halves{};

    std::span<Piece> of(std::vector<Piece>& pieces) const {
        return std::span(pieces).subspan(first_piece, piece_count);
    }
};

void add_pieces(LargeSplit& split, size_t piece_size, std::vector<Piece>& pieces) {
    split.first_piece = pieces.size();
    for (std::span rest = split.range->primitives; !rest.empty();
         rest = rest.subspan(pieces.back().primitives.size()))
        pieces.push_back({split.range, rest.first(std::min(piece_size, rest.size()))});
    split.piece_count = pieces.size() - split.first_piece;
}

// The pieces have their bins. They know where their primitives go from how many the others have.
void choose_plane(LargeSplit& split, std::vector<Piece>& all_pieces) {
    const auto pieces = split.of(all_pieces);
    Bins bins(*split.range);
    for (const Piece& piece : pieces) bins.add(*piece.bins);
    const Plane plane = plane_for(*split.range, bins);
    if (!std::isfinite(plane.cost)) return;
    split.halves = halves_of(*split.range, bins, plane);
    std::array<size_t, 2> next{0, split.halves->front().primitives.size()};
    for (Piece& piece : pieces) {
        piece.plane = plane;
        piece.next = next;
        next[0] += piece.bins->left(plane).count;
        next[1] += piece.bins->right(plane).count;
    }
}

}  // namespace

std::optional<Halves> split(const Range& range) {
    if (range.halves) return *range.halves;
    const size_t count = range.primitives.size();
    if (count <= max_leaf_triangles) return split_few(range);
    Bins bins(range);
    bins.add(range.primitives);
    const Plane plane = plane_for(range, bins);
    if (!std::isfinite(plane.cost)) return halve(range);
    Halves halves = halves_of(range, bins, plane);
    const auto places = move(range.primitives, bins, plane, range.room, {0, halves[0].primitives.size()});
    for (size_t side = 0; side < 2; ++side) halves[side].places = places[side];
    return halves;
}

// One level of the tree at a time: so all threads have work, and wait for each other three times a level.
LargeRanges::LargeRanges(Range& all, size_t size) {
    std::vector<LargeSplit> level;
    if (all.primitives.size() > size) level.push_back({&all});
    while (!level.empty()) {
        std::vector<Piece> pieces;
        for (LargeSplit& split : level) add_pieces(split, size, pieces);
        in_parallel(pieces.size(), 1, [&](size_t i, size_t) {
            pieces[i].bins = std::make_unique<Bins>(*pieces[i].range);
            pieces[i].bins->add(pieces[i].primitives);
        });
        in_parallel(level.size(), 1, [&](size_t i, size_t) { choose_plane(level[i], pieces); });
        in_parallel(pieces.size(), 1, [&](size_t i, size_t) {
            Piece& piece = pieces[i];
            if (!std::isfinite(piece.plane.cost)) return;
            piece.places = move(piece.primitives, *piece.bins, piece.plane, piece.range->room, piece.next);
        });
        std::vector<LargeSplit> next;
        for (const LargeSplit& split : level) {
            if (!split.halves) continue;
            Halves& halves = halves_.emplace_back(*split.halves);
            split.range->halves = &halves;
            for (size_t side = 0; side < 2; ++side) {
                for (const Piece& piece : split.of(pieces)) halves[side].places.add(piece.places[side]);
                if (halves[side].primitives.size() > size) next.push_back({&halves[side]});
            }
        }
        level = std::move(next);
    }
}

}  // namespace lab::bvh
