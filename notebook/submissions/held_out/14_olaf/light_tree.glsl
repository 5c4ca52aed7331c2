// The light tree: the importance of its nodes, the way down to a triangle, and how likely that is.

// The least squared distance that counts, as a multiple of a node's squared radius. Measured: smaller ones make clusters around a
// point too likely, larger ones those on their other side too unlikely.
const float LEAST_SQUARE = 0.15;

// The mean of max(h, 0) over heights h that lie evenly between middle - width and middle + width.
vec4 get_mean_height(vec4 middle, vec4 width) {
    vec4 above = clamp(middle, -width, width) + width;
    return above * above / (4.0 * width) + max(middle - width, 0.0);
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
    // power · cos θ' · cos θ / r²
    vec4 importance = node.power * light_height * height;
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
        vec2 halves = vec2(importance.x + importance.y, importance.z + importance.w);
        float sum = halves.x + halves.y;
        bool is_first_half = is_first_chosen(halves / sum, digits);
        vec2 pair = is_first_half ? importance.xy : importance.zw;
        uvec2 children = is_first_half ? node.child.xy : node.child.zw;
        bool is_first = is_first_chosen(pair / (pair.x + pair.y), digits);
        probability *= (is_first ? pair.x : pair.y) / sum;
        child = is_first ? children.x : children.y;
    }
    u.x = to_numbers(digits).x;
    LightTriangle light = light_triangles[child - IS_LIGHT_LEAF];
    light.inverse_density = light_leaves[get_light_place(light.instance, light.triangle)].area / probability;
    return light;
}

// The probability with which the receiver's light sample chooses a leaf. Its trail says which children lead there.
float get_tree_probability(Receiver receiver, uint trail) {
    float probability = 1.0;
    for (uint child = 0u; child < IS_LIGHT_LEAF; trail >>= 2u) {
        LightNode node = light_nodes[child];
        vec4 importance = get_importance(node, receiver);
        float sum = (importance.x + importance.y) + (importance.z + importance.w);
        probability *= importance[trail & 3u] / sum;
        child = node.child[trail & 3u];
    }
    return probability;
}
