// The light tree: the importance of its nodes, the way down to a triangle, and how likely that is.

// The least squared distance that counts, as a multiple of a node's squared radius. Measured: smaller ones make clusters around a
// point too likely, larger ones those on their other side too unlikely.
const float LEAST_SQUARE = 0.15;

// The mean of max(h, 0) over heights h that lie evenly between middle - width and middle + width.
vec4 get_mean_height(vec4 middle, vec4 width) {
    // The integral of max(h, 0) from bottom to top over its length: the middle if all is above, else the part of a triangle that is.
    vec4 top = max(middle + width, 0.0);
    return mix(top * top / (4.0 * width), middle, greaterThan(middle, width));
}

// An estimate of the light that a point gets from each child's triangles, if nothing is in between: power · cos θ' · cos θ / r².
// Every cosine is a height over a plane, divided by the distance: the point's height over the triangles' planes, and theirs over
// the point's. Where these differ we take a mean, so it is 0 only where no light can arrive.
vec4 get_importance(LightNode node, Receiver receiver) {
    vec3 x = receiver.position, n = receiver.normal;
    vec4 to_x = node.centre_x - x.x, to_y = node.centre_y - x.y, to_z = node.centre_z - x.z;
    vec4 square = to_x * to_x + to_y * to_y + to_z * to_z, distance = sqrt(square);
    vec4 size = node.radius + 8.0 * ROUNDING * distance;
    vec4 light_height = get_mean_height(-(node.mean_normal_x * to_x + node.mean_normal_y * to_y + node.mean_normal_z * to_z),
                                        size + node.spread * distance);
    vec4 height = get_mean_height(n.x * to_x + n.y * to_y + n.z * to_z, size);
    // Within the sphere the distance to its centre says little.
    square = max(square, LEAST_SQUARE * node.radius * node.radius);
    if (n == vec3(0.0)) height = sqrt(square);
    vec4 importance = node.power * (light_height / square) * (height / square);
    // Where no light arrives from any child, any will do.
    return importance == vec4(0.0) ? vec4(1.0, 0.0, 0.0, 0.0) : importance;
}

// Chooses the first of two with the given probabilities by a number in [0,1) of 64 binary digits, and turns its position within
// the part that was chosen into a new number. If numbers are stratified, so are the new ones, except for their last digits: a
// hash provides those.
bool is_first_chosen(vec2 probabilities, inout uvec2 digits) {
    // The less likely part comes first, since numbers close to 0 have the most digits.
    bool is_turned = probabilities.x > probabilities.y;
    float width = 4294967296.0 * min(probabilities.x, probabilities.y);
    uvec2 end = uvec2(uint(width), uint(4294967296.0 * fract(width)));
    bool is_below = digits.x < end.x || (digits.x == end.x && digits.y < end.y);
    uvec2 fresh = digits;
    advance_random_state(fresh);
    if (!is_below) {
        digits.x -= end.x + uint(digits.y < end.y);
        digits.y -= end.y;
        width = 4294967296.0 - width;
    }
    float rest = (float(digits.x) + float(digits.y) / 4294967296.0) / width;
    digits = uvec2((uint(min(16777216.0 * rest, 16777215.0)) << 8u) | (fresh.x >> 24u), fresh.y);
    return is_below != is_turned;
}

// Descends the tree: one number decides at all nodes, and what is left of it is the first of the two numbers for a point. At each
// node it chooses one half of the children, and then one of these two. 1 minus the probability of the first would round to
// 0 for a dim second one.
LightTriangle choose_light_by_tree(Receiver receiver, inout uvec2 seed, out vec2 u) {
    uvec2 words = get_random_words(seed), digits = words;
    u = to_numbers(words);
    advance_random_state(digits);
    digits = uvec2(words.x, digits.x);
    float probability = 1.0;
    uint child = 0u;
    while (child < IS_LIGHT_LEAF) {
        LightNode node = light_nodes[child];
        vec4 importance = get_importance(node, receiver);
        // The last two children against the first two, and then the second of a pair against its first.
        float front = importance[0] + importance[1], back = importance[2] + importance[3];
        bool goes_back = is_first_chosen(vec2(back, front) / (front + back), digits);
        uint base = goes_back ? 2u : 0u;
        float one = importance[base], other = importance[base + 1u];
        uint chosen = base + (is_first_chosen(vec2(other, one) / (one + other), digits) ? 1u : 0u);
        probability *= importance[chosen] / (front + back);
        child = node.child[chosen];
    }
    u.x = to_numbers(digits).x;
    LightTriangle light = light_triangles[child - IS_LIGHT_LEAF];
    light.inverse_density = light_leaves[get_light_place(light.instance, light.triangle)].area / probability;
    return light;
}

// The probability with which the receiver's light sample chooses a leaf. Its trail says which children lead there.
float get_tree_probability(Receiver receiver, uint trail) {
    float product = 1.0;
    uint place = 0u;
    do {
        LightNode node = light_nodes[place];
        vec4 shares = get_importance(node, receiver);
        uint turn = bitfieldExtract(trail, 0, 2);
        product *= shares[turn] / dot(shares, vec4(1.0));
        place = node.child[turn];
        trail >>= 2u;
    } while (place < IS_LIGHT_LEAF && product > 0.0);
    return product;
}
